//! Runs the program as a user would.

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::sync::LazyLock;

pub const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/figure-07.toml");
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_energywave");

/// The OpenCL device under test.
pub fn device() -> &'static str {
    static DEVICE: LazyLock<String> =
        LazyLock::new(|| std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned()));
    &DEVICE
}

/// A fresh folder, with a space in its name, in which the program runs.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(
            tempfile::Builder::new()
                .prefix("with space ")
                .tempdir()
                .unwrap(),
        )
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(self.path());
        command.env_remove("ENERGYWAVE_DEVICE"); // what is typed decides
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command().args(arguments).output().unwrap()
    }

    /// Renders `SCENE` to a name, with further arguments.
    pub fn render(&self, name: &str, arguments: &[&str]) -> Output {
        let all = [&["render", SCENE, "-o", name], arguments].concat();
        self.run(&all)
    }

    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect()
    }
}

/// Waits until the program names its device: then it catches Ctrl-C, and the work begins.
pub fn wait_for_the_device(child: &mut Child) {
    let mut line = String::new();
    let mut byte = [0];
    let errors = child.stderr.as_mut().unwrap();
    while !line.contains("device: ") {
        assert_eq!(errors.read(&mut byte).unwrap(), 1, "it ended first: {line}");
        line.push(char::from(byte[0]));
    }
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[track_caller]
pub fn expect(output: &Output, code: i32, words: &str) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.contains(words), "{message}\nhas not: {words}");
    assert!(!message.contains("panicked"), "{message}");
}
