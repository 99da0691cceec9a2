//! The JSON Schema of scene files, as editors use it.

use amontons::scene::BUILTIN;
use amontons_export::scene::schema;

#[test]
fn the_shipped_schema_is_the_one_of_the_types() {
    assert!(
        include_str!("../../../../scenes/scene.schema.json") == schema(),
        "the types of the scene file have changed; write their schema anew with\n  \
         cargo run -- scenes schema > scenes/scene.schema.json"
    );
}

#[test]
fn the_shipped_scenes_name_their_schema_as_editors_look_for_it() {
    for builtin in BUILTIN {
        assert!(builtin.text.starts_with("#:schema ./scene.schema.json\n"), "{}", builtin.name);
    }
}

#[test]
fn every_key_has_a_description_for_who_writes_a_scene() {
    fn visit(path: &str, schema: &serde_json::Value) {
        assert!(schema["description"].is_string(), "{path}");
        let items = schema.get("items").unwrap_or(schema);
        let alternatives = items["anyOf"].as_array().map_or(&[][..], Vec::as_slice);
        for table in alternatives.iter().chain([items]) {
            for (key, schema) in table["properties"].as_object().into_iter().flatten() {
                visit(&format!("{path}.{key}"), schema);
            }
        }
    }
    visit("", &serde_json::from_str(&schema()).unwrap());
}

#[test]
fn the_fuzzer_knows_every_key_and_every_word_that_is_a_value() {
    fn visit(schema: &serde_json::Value, words: &mut Vec<String>) {
        let children: Vec<&serde_json::Value> = match schema {
            serde_json::Value::Object(object) => {
                let keys = object.get("properties").and_then(|keys| keys.as_object());
                words.extend(keys.into_iter().flatten().map(|(key, _)| key.clone()));
                let values = object.get("enum").and_then(|values| values.as_array());
                let values = values.into_iter().flatten().chain(object.get("const"));
                words.extend(values.filter_map(|word| Some(word.as_str()?.to_owned())));
                object.values().collect()
            }
            serde_json::Value::Array(items) => items.iter().collect(),
            _ => return,
        };
        children.into_iter().for_each(|child| visit(child, words));
    }
    let mut words = Vec::new();
    visit(&serde_json::from_str(&schema()).unwrap(), &mut words);
    assert!(words.iter().any(|word| word == "stribeck_velocity"), "{words:?}");
    let known = include_str!("../../../../fuzz/scene.dict");
    for word in words {
        let line = format!("\"{word}\"");
        assert!(known.lines().any(|known| known == line), "fuzz/scene.dict lacks {line}");
    }
}
