//! The contact states that a user names.

use super::linearised::Linearised;
use amontons::Error;
use amontons::contact::{ContactState, parse_states};
use amontons::scene::{Scene, did_you_mean};

/// The name of the pattern of the equilibrium.
const EQUILIBRIUM: &str = "equilibrium";
/// The name that stands for all contacts that no other name in the list stands for.
const OTHERS: &str = "*";

/// The contact states of this name: those of the equilibrium (`equilibrium`), of contacts and sets of contacts by their names,
/// the later names before the earlier ones (`lining=St,edge=Dt,*=Sl`), or one for all or one for each as [`parse_states`] reads
/// them. Contacts that are not named have their state in the equilibrium.
///
/// # Errors
/// Returns an error if no state or contact has this name, or there is no equilibrium that gives the others.
pub fn named_states(
    name: &str,
    scene: &Scene,
    here: &Linearised,
) -> Result<Vec<ContactState>, Error> {
    if name == EQUILIBRIUM {
        return here.equilibrium_states();
    }
    if !name.contains('=') {
        return parse_states(name, scene.contact_count());
    }
    let mut states = vec![None; scene.contact_count()];
    let mut others = None;
    for part in name.split(',') {
        let (name, state) = part.split_once('=').ok_or_else(|| {
            Error::argument(format!(
                "{part} names no state: give NAME=STATE with commas between, as in pad=St,*=Sl"
            ))
        })?;
        let (name, state) = (name.trim(), parse_states(state.trim(), 1)?[0]);
        if name == OTHERS {
            others = Some(state);
            continue;
        }
        let mut is_known = false;
        for (contact, place) in states.iter_mut().enumerate() {
            if is_named(scene, contact, name) {
                (*place, is_known) = (Some(state), true);
            }
        }
        if !is_known {
            return Err(unknown(scene, name));
        }
    }
    let equilibrium = match others {
        None if states.contains(&None) => here.equilibrium_states()?,
        _ => vec![ContactState::Slide; states.len()],
    };
    let states = states.into_iter().zip(equilibrium);
    Ok(states.map(|(named, equilibrium)| named.or(others).unwrap_or(equilibrium)).collect())
}

/// `true` if the name is that of a contact (from 0), with or without `contact.`, or of its set.
fn is_named(scene: &Scene, contact: usize, name: &str) -> bool {
    let full = scene.contact_name(contact);
    let set = scene.network().and_then(|network| {
        let set = network.contacts[contact].set?;
        Some(&*network.contact_sets[set])
    });
    full == name || full.strip_prefix("contact.") == Some(name) || set == Some(name)
}

fn unknown(scene: &Scene, name: &str) -> Error {
    let sets = scene.network().map_or(&[][..], |network| &network.contact_sets).iter().cloned();
    let contacts = (0..scene.contact_count()).map(|contact| scene.contact_name(contact));
    let short = |full: String| full.strip_prefix("contact.").map_or(full.clone(), str::to_owned);
    let names: Vec<String> = sets.chain(contacts.map(short)).collect();
    let help = did_you_mean(name, names.iter().map(|name| &**name)).unwrap_or_else(|| {
        let shown = names.iter().take(8).cloned().collect::<Vec<_>>().join(", ");
        let more = if names.len() > 8 { " and more" } else { "" };
        format!("there are {shown}{more}, and {OTHERS} for all others")
    });
    Error::argument(format!("{} has no contact and no set of contacts {name}; {help}", scene.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::contact::ContactState::{Detached, Slide, Stick};
    use amontons::scene::builtin;

    #[test]
    fn contacts_are_named_one_by_one_and_all_others_at_once() {
        let scene = builtin("set2").unwrap().scene();
        let here = Linearised::of(&scene);
        let states = |name: &str| named_states(name, &scene, &here);
        assert_eq!(states("contact[2]=St").unwrap(), [Slide, Stick]);
        assert_eq!(states("*=Dt, contact[1]=St").unwrap(), [Stick, Detached]);
        assert_eq!(states("equilibrium").unwrap(), [Slide, Slide]);
        assert_eq!(states("St").unwrap(), [Stick, Stick]);
        for (name, fault) in [
            ("contact[3]=St", "has no contact and no set of contacts contact[3]"),
            ("pad=St", "there are contact[1], contact[2]"),
            ("contact[1]=St,Sl", "Sl names no state"),
            ("contact[1]=st", "st is not a contact state"),
        ] {
            let found = states(name).unwrap_err().to_string();
            assert!(found.contains(fault), "{found}");
        }
    }
}
