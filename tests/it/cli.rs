//! The program as a person or a script meets it: arguments in; exit code, standard output and standard error out.

mod input;
mod matrices;
mod solve;
mod study;
mod usage;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// What is refused before the work starts is refused within this, on a machine busy with other things; the work itself would take minutes
/// to years.
const AT_ONCE: Duration = Duration::from_secs(20);

/// The Cornell box as a scene file, `$resolution` pixels wide.
const CORNELL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/data/cornell.xml");

/// A closed cube of albedo `$albedo` that emits 1 all over, without a camera: L = 1 / (1 − albedo).
const FURNACE: &str = r#"<scene version="3.0.0">
    <default name="albedo" value="0.5"/>
    <shape type="cube" id="walls">
        <boolean name="flip_normals" value="true"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="$albedo, $albedo, $albedo"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="1, 1, 1"/></emitter>
    </shape>
</scene>
"#;

/// A folder to run the program in, gone at the end of the test.
struct Desk(TempDir);

/// How a run ended and what it said.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
    took: Duration,
}

impl Desk {
    fn new(files: &[(&str, &[u8])]) -> Self {
        let desk = Self(TempDir::new().expect("the temporary folder can be written"));
        for (name, bytes) in files {
            fs::write(desk.path(name), bytes).expect("files can be written");
        }
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Names of all that lies in a folder, in order.
    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).expect("the folder is there");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("it can be listed").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_etendue"));
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    fn run(&self, arguments: &[&str]) -> Run {
        let start = Instant::now();
        let output = self.command(arguments).output().expect("the program starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program writes UTF-8");
        let (stdout, stderr) = (text(output.stdout), text(output.stderr));
        Run { code: output.status.code(), stdout, stderr, took: start.elapsed() }
    }

    /// Runs what must succeed and parses the one object on standard output.
    fn json(&self, arguments: &[&str]) -> Value {
        let run = self.run(arguments);
        assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
        run.object()
    }
}

/// Runs the program in an empty folder.
fn etendue(arguments: &[&str]) -> Run {
    Desk::new(&[]).run(arguments)
}

impl Run {
    /// Standard output as one JSON object, and nothing else.
    fn object(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout).expect("standard output is one JSON value");
        assert!(value.is_object() && self.stdout.ends_with("}\n"), "{}", self.stdout);
        assert_snake_case(&value);
        value
    }

    /// Holds a refusal to its code, and to a message that says all of `words`; nothing is on standard output.
    fn assert_refused(&self, code: i32, words: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (Some(code), ""), "{}", self.stderr);
        assert!(self.stderr.starts_with("error") || self.stderr.contains("\nerror"), "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "'{word}' is not in: {}", self.stderr);
        }
        assert!(!self.stderr.contains("internal error") && !self.stderr.contains("panicked"), "{}", self.stderr);
    }
}

/// Every key at every depth.
fn assert_snake_case(value: &Value) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let snake = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
                assert!(key.starts_with(|c: char| c.is_ascii_lowercase()) && key.chars().all(snake), "key '{key}'");
                assert_snake_case(value);
            }
        }
        Value::Array(values) => values.iter().for_each(assert_snake_case),
        _ => {}
    }
}

/// Numbers of an array.
fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().unwrap_or_else(|| panic!("{value} is no array"));
    values.iter().map(|v| v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn read_json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("the file is there")).expect("the file is JSON")
}
