//! Chromium without a window, by the DevTools protocol over a pipe: JSON messages that end with a zero byte. A pipe
//! needs no port, no driver and no package beside the browser.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A browser with one page.
pub struct Browser {
    process: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    session: String,
    count: u64,
    /// Messages that the page wrote to its console, its exceptions, and requests that its policy refused.
    pub complaints: Vec<String>,
    _profile: TempDir,
}

impl Browser {
    /// # Panics
    /// There is no Chromium, with what to install.
    pub fn start() -> Self {
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let is_there = |name: &&str| {
            let run = Command::new(name).arg("--version").stderr(Stdio::null()).output();
            run.is_ok_and(|output| output.status.success())
        };
        let name = names.into_iter().find(is_there).unwrap_or_else(|| {
            panic!("there is no Chromium, in which reports are tested; install it (Debian: apt install chromium)")
        });
        let profile = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
        // The protocol's pipe is 3 (to the browser) and 4 (from it). No sandbox: containers forbid to make one, and
        // the only page that it opens is ours.
        let command = format!(
            "exec {name} --headless --no-sandbox --disable-gpu --no-first-run --disable-dev-shm-usage \
             --disable-background-networking --remote-debugging-pipe --user-data-dir=\"$0\" about:blank \
             3<&0 4>&1 0</dev/null 1>/dev/null 2>/dev/null"
        );
        let mut process = Command::new("sh")
            .args(["-c", &command])
            .arg(profile.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (to, from) = (process.stdin.take().unwrap(), process.stdout.take().unwrap());
        let mut browser = Self {
            process,
            to,
            from: BufReader::new(from),
            session: String::new(),
            count: 0,
            complaints: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", &json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", &attach);
        browser.session = attached["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable", "Network.enable"] {
            browser.call(domain, &json!({}));
        }
        browser
    }

    fn message(&mut self) -> Value {
        let mut bytes = Vec::new();
        self.from.read_until(0, &mut bytes).unwrap();
        assert_eq!(bytes.pop(), Some(0), "Chromium has ended");
        let message: Value = serde_json::from_slice(&bytes).unwrap();
        let heard = match message["method"].as_str().unwrap_or_default() {
            "Runtime.consoleAPICalled" | "Runtime.exceptionThrown" | "Log.entryAdded" => true,
            "Network.requestWillBeSent" => {
                let address = message["params"]["request"]["url"].as_str().unwrap();
                !address.starts_with("file:") && !address.starts_with("data:")
            }
            _ => false,
        };
        if heard {
            self.complaints.push(message["params"].to_string());
        }
        message
    }

    /// Sends a command and waits for its result.
    fn call(&mut self, method: &str, params: &Value) -> Value {
        self.count += 1;
        let mut command = json!({ "id": self.count, "method": method, "params": params });
        if !self.session.is_empty() {
            command["sessionId"] = json!(self.session);
        }
        self.to.write_all(command.to_string().as_bytes()).unwrap();
        self.to.write_all(&[0]).unwrap();
        loop {
            let message = self.message();
            if message["id"] == self.count {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].clone();
            }
        }
    }

    /// Opens a file in a window of this width.
    pub fn open(&mut self, path: &Path, width: u32) {
        let size =
            json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.call("Emulation.setDeviceMetricsOverride", &size);
        // The previous page may still be shown for a time.
        self.eval("document.documentElement.dataset.old = 1");
        self.call("Page.navigate", &json!({ "url": format!("file://{}", path.display()) }));
        let state = "document.documentElement?.dataset.old ? 'old' : document.readyState";
        let started = Instant::now();
        while self.text(state) != "complete" {
            assert!(started.elapsed() < Duration::from_secs(60), "the page does not open");
        }
        let address = self.text("location.href");
        assert!(address.starts_with("file:"), "{address} in place of {}", path.display());
        self.settle();
    }

    /// Waits for two frames: what watches sizes has then been told.
    pub fn settle(&mut self) {
        self.eval("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    }

    /// The value of an expression on the page.
    pub fn eval(&mut self, expression: &str) -> Value {
        let evaluate =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", &evaluate);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {}",
            answer["exceptionDetails"]
        );
        answer["result"]["value"].clone()
    }

    pub fn text(&mut self, expression: &str) -> String {
        let value = self.eval(expression);
        value.as_str().unwrap_or_else(|| panic!("{expression} is {value}")).to_owned()
    }

    pub fn number(&mut self, expression: &str) -> f64 {
        let value = self.eval(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// Prefers the scheme `light` or `dark`.
    pub fn prefer(&mut self, scheme: &str) {
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.call("Emulation.setEmulatedMedia", &json!({ "features": [feature] }));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Its own way ends its helpers, too; they would go on writing to the profile.
        self.session.clear();
        let close = json!({ "id": 0, "method": "Browser.close" }).to_string();
        let asked = self.to.write_all(close.as_bytes()).and_then(|()| self.to.write_all(&[0]));
        if asked.is_err() {
            let _ = self.process.kill();
        }
        let _ = self.process.wait();
    }
}
