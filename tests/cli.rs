//! The program: exit codes, messages, outputs, and what it does where OpenCL is missing or broken.
#![allow(clippy::unwrap_used, clippy::panic)]
#![cfg(unix)] // shells, signals and the loader's environment variables

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use energywave::RadianceImage;
use serde_json::Value;

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/figure-07.toml");
const PROGRAM: &str = env!("CARGO_BIN_EXE_energywave");

/// The OpenCL device under test.
fn device() -> &'static str {
    static DEVICE: LazyLock<String> =
        LazyLock::new(|| std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned()));
    &DEVICE
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(
            tempfile::Builder::new()
                .prefix("with space ")
                .tempdir()
                .unwrap(),
        )
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn command(&self) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(self.path());
        command.env_remove("ENERGYWAVE_DEVICE"); // what is typed decides
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command().args(arguments).output().unwrap()
    }

    /// Renders `SCENE` to a name, with further arguments.
    fn render(&self, name: &str, arguments: &[&str]) -> Output {
        let all = [&["render", SCENE, "-o", name], arguments].concat();
        self.run(&all)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect()
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[track_caller]
fn expect(output: &Output, code: i32, words: &str) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.contains(words), "{message}\nhas not: {words}");
    assert!(!message.contains("panicked"), "{message}");
}

#[test]
fn render_writes_png_and_exr_and_names_the_device() {
    let folder = Folder::new();
    for name in ["out.png", "out.exr", "OUT.PNG"] {
        let output = folder.render(name, &["--size", "40x30"]);
        expect(&output, 0, "device: ");
        assert!(output.stdout.is_empty());
    }
    let image = RadianceImage::open(folder.path().join("out.exr")).unwrap();
    assert_eq!((image.size().width, image.size().height), (40, 30));
    assert!(image.pixel(20, 15).unwrap()[2] > 0.1);
    let png = std::fs::read(folder.path().join("out.png")).unwrap();
    assert_eq!(&png[..4], b"\x89PNG");
    assert_eq!(
        folder.names().len(),
        3,
        "temporary files left: {:?}",
        folder.names()
    );
}

#[test]
fn the_reference_and_the_opencl_device_draw_the_same_picture() {
    let folder = Folder::new();
    expect(
        &folder.render("a.exr", &["--size", "32x32", "--device", "reference"]),
        0,
        "reference",
    );
    expect(
        &folder.render("b.exr", &["--size", "32x32", "--device", device()]),
        0,
        "device: ",
    );
    let open = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
    let found = energywave::image::compare(&open("b.exr"), &open("a.exr")).unwrap();
    assert!(found.max < 2e-4 && found.max > 0.0, "{found:?}");
}

#[test]
fn overrides_replace_the_scenes_values() {
    let folder = Folder::new();
    let reference = ["--size", "16x16", "--device", "reference"];
    for (name, more) in [
        ("a.exr", vec!["--divisions", "8"]),
        ("b.exr", vec!["--divisions", "200"]),
        ("c.exr", vec!["--method", "exact"]),
        ("d.exr", vec!["--method", "simpson", "--divisions", "65536"]),
    ] {
        expect(
            &folder.render(name, &[&reference[..], &more].concat()),
            0,
            "",
        );
    }
    let open = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
    let exact = open("c.exr");
    let off = |name: &str| energywave::image::compare(&open(name), &exact).unwrap().max;
    assert!(off("a.exr") > off("b.exr") && off("b.exr") > off("d.exr"));
    assert!(off("d.exr") < 1e-5, "{}", off("d.exr"));
}

#[test]
fn usage_errors_exit_with_2_and_write_nothing() {
    let folder = Folder::new();
    expect(&folder.run(&[]), 2, "Usage");
    expect(&folder.run(&["paint"]), 2, "paint");
    expect(&folder.run(&["render", SCENE]), 2, "--output");
    expect(
        &folder.render("out.gif", &[]),
        2,
        "out.gif: unknown output ending; use .png",
    );
    expect(&folder.render("out", &[]), 2, "unknown output ending");
    expect(
        &folder.render("out.png", &["--size", "0x4"]),
        2,
        "two positive numbers",
    );
    expect(&folder.render("out.png", &["--size", "-3x4"]), 2, "--size");
    expect(&folder.render("out.png", &["--size", "640"]), 2, "640x360");
    expect(
        &folder.render("out.png", &["--divisions", "3"]),
        2,
        "even number",
    );
    expect(
        &folder.render("out.png", &["--divisions", "0"]),
        2,
        "even number",
    );
    expect(
        &folder.render("out.png", &["--tolerance", "0"]),
        2,
        "tolerance",
    );
    expect(
        &folder.render("out.png", &["--method", "romberg"]),
        2,
        "simpson, exact",
    );
    let exact = folder.render("out.png", &["--method", "exact", "--device", device()]);
    expect(&exact, 2, "use --device reference, or --method simpson");
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

#[test]
fn an_image_beyond_the_limit_exits_with_3() {
    let folder = Folder::new();
    expect(
        &folder.render("out.png", &["--size", "16385x4"]),
        3,
        "at most 16384x16384",
    );
    assert!(folder.names().is_empty());
}

#[test]
fn a_device_that_is_not_there_or_fits_two_exits_with_4() {
    let folder = Folder::new();
    expect(
        &folder.render("out.png", &["--device", "voodoo"]),
        4,
        "no device \"voodoo\"; there are:",
    );
    expect(
        &folder.render("out.png", &["--device", "99"]),
        4,
        "no device \"99\"",
    );
    let variable = |name: &str, value: &str, arguments: &[&str]| {
        let mut command = folder.command();
        command.args(["render", SCENE, "-o", "out.png", "--size", "8x8"]);
        command.args(arguments).env(name, value).output().unwrap()
    };
    expect(
        &variable("ENERGYWAVE_DEVICE", "voodoo", &[]),
        4,
        "no device \"voodoo\"",
    );
    let both = variable("POCL_DEVICES", "pthread pthread", &["--device", "pthread"]);
    expect(&both, 4, "fits 2 devices");
    assert!(stderr(&both).contains("0: pthread") && stderr(&both).contains("1: pthread"));
    assert!(folder.names().is_empty());
    expect(
        &variable("ENERGYWAVE_DEVICE", "voodoo", &["--device", "reference"]),
        0,
        "reference",
    );
}

#[test]
fn outputs_that_cannot_be_written_exit_with_7_before_the_work() {
    let folder = Folder::new();
    let begun = Instant::now();
    let large = ["--size", "16000x16000"];
    expect(
        &folder.render("none/out.png", &large),
        7,
        "there is no folder none; create it first",
    );
    std::fs::create_dir(folder.path().join("out.png")).unwrap();
    expect(&folder.render("out.png", &large), 7, "it is a folder");
    expect(
        &folder.render("/proc/out.png", &large),
        7,
        "/proc/out.png: cannot write",
    );
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "the image was computed first"
    );
}

#[test]
fn a_write_that_fails_midway_exits_with_7_and_leaves_nothing() {
    let folder = Folder::new();
    // A limit on the size of files stands for a full disk: it too stops a write after some kilobytes.
    let script = format!(
        "trap '' XFSZ; ulimit -f 8; exec '{PROGRAM}' render '{SCENE}' -o out.exr --device reference"
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output()
        .unwrap();
    expect(&output, 7, "File too large");
    assert!(
        stderr(&output).contains("out.exr: cannot write"),
        "{}",
        stderr(&output)
    );
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

#[test]
fn an_image_too_large_for_the_memory_exits_with_5() {
    let folder = Folder::new();
    let script = format!(
        "ulimit -v 3000000; exec '{PROGRAM}' render '{SCENE}' -o out.exr --device reference --size 16384x16384"
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output()
        .unwrap();
    expect(&output, 5, "make the image smaller");
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

#[test]
fn ctrl_c_exits_with_130_and_leaves_nothing() {
    let folder = Folder::new();
    let child = folder
        .command()
        .args([
            "render",
            SCENE,
            "-o",
            "out.png",
            "--device",
            "reference",
            "--size",
            "8000x8000",
        ])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    // The temporary file beside the target says that the work has begun.
    while folder.names().is_empty() {
        assert!(
            begun.elapsed() < Duration::from_secs(20),
            "the work never began"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    let interrupt = format!("kill -INT {}", child.id()); // the shell's own: minimal systems have no other
    assert!(
        Command::new("sh")
            .args(["-c", &interrupt])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    expect(&output, 130, "interrupted");
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

/// A folder with a file `libOpenCL.so.1` that is no library: the loader is there and cannot be loaded.
fn without_loader(folder: &Folder) -> PathBuf {
    let path = folder.path().join("libraries");
    std::fs::create_dir(&path).unwrap();
    std::fs::write(path.join("libOpenCL.so.1"), "no library").unwrap();
    path
}

#[test]
fn without_opencl_the_reference_draws_and_one_line_says_what_to_install() {
    let folder = Folder::new();
    let libraries = without_loader(&folder);
    let empty = folder.path().join("vendors");
    std::fs::create_dir(&empty).unwrap();
    for (variable, value, words) in [
        (
            "LD_LIBRARY_PATH",
            libraries.as_path(),
            "install ocl-icd-libopencl1",
        ),
        (
            "OCL_ICD_VENDORS",
            empty.as_path(),
            "install pocl-opencl-icd",
        ),
    ] {
        let mut command = folder.command();
        command.args(["render", SCENE, "-o", "out.png", "--size", "8x8"]);
        let output = command.env(variable, value).output().unwrap();
        expect(&output, 0, words);
        assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
        assert!(stderr(&output).contains("reference"));
        assert!(folder.names().contains(&"out.png".to_owned()));

        let devices = folder
            .command()
            .arg("devices")
            .env(variable, value)
            .output()
            .unwrap();
        expect(&devices, 0, words);

        let cpu = folder
            .command()
            .args(["verify", "--device", device()])
            .env(variable, value)
            .output()
            .unwrap();
        expect(&cpu, 4, words);
    }
}

#[test]
fn a_failing_kernel_build_exits_with_5_and_names_file_and_line() {
    let folder = Folder::new();
    let build = |options: &str| {
        let mut command = folder.command();
        command.args(["render", SCENE, "-o", "out.png", "--device", device()]);
        command
            .env("ENERGYWAVE_BUILD_OPTIONS", options)
            .output()
            .unwrap()
    };
    let lanes = build("-DLANES=3");
    expect(&lanes, 5, "LANES must be 1, 4, 8 or 16");
    let line = 1 + include_str!("../cl/lanes.h")
        .lines()
        .position(|l| l.contains("#error"))
        .unwrap();
    assert!(
        stderr(&lanes).contains(&format!("cl/lanes.h:{line}")),
        "{}",
        stderr(&lanes)
    );
    expect(&build("-cl-no-such-option"), 5, "CL_INVALID_BUILD_OPTIONS");
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

#[test]
fn devices_lists_every_property_and_one_default() {
    let output = Folder::new().run(&["devices", "--json"]);
    expect(&output, 0, "");
    let list: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    for device in &list {
        for key in [
            "index",
            "compute_units",
            "memory_bytes",
            "max_allocation_bytes",
            "lanes",
        ] {
            assert!(device[key].is_u64(), "{key}: {device}");
        }
        for key in ["name", "type", "platform", "version", "driver"] {
            assert!(device[key].is_string(), "{key}: {device}");
        }
    }
    assert_eq!(
        list.iter()
            .filter(|device| device["default"] == true)
            .count(),
        1
    );
    assert_eq!(list.last().unwrap()["type"], "reference");
    expect(&Folder::new().run(&["devices"]), 0, "default: ");
}

#[test]
fn verify_prints_a_row_for_every_ray_and_fails_on_a_wrong_one() {
    let folder = Folder::new();
    let output = folder.run(&["verify", "--json", "--device", device()]);
    expect(&output, 0, "112 of 112 values within their limits");
    for words in [
        "kind beam:",
        "kind sphere-inverse-square:",
        "method exact not built yet",
    ] {
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows.len(), 112);
    assert_eq!(rows[32]["kind"], "torus");
    assert!(
        rows.iter()
            .all(|row| row["relative_error"].as_f64().unwrap() < 1e-3)
    );

    let mut rays: Vec<Value> = serde_json::from_str(include_str!("data/rays.json")).unwrap();
    rays.truncate(3);
    rays[1]["simpson_200"] = (rays[1]["simpson_200"].as_f64().unwrap() * 1.01).into();
    let file = folder.path().join("rays.json");
    std::fs::write(&file, serde_json::to_string(&rays).unwrap()).unwrap();
    let spoiled = folder.run(&[
        "verify",
        "--rays",
        "rays.json",
        "--json",
        "--device",
        device(),
    ]);
    expect(
        &spoiled,
        6,
        "2 of 3 values within their limits; the worst is ray 1",
    );
    let rows: Vec<Value> = serde_json::from_slice(&spoiled.stdout).unwrap();
    assert_eq!(
        rows.len(),
        3,
        "the rows are printed before the program fails"
    );
    expect(
        &folder.run(&["verify", "--rays", "rays.json", "--device", device()]),
        6,
        "ray 1",
    );

    std::fs::write(&file, "[{\"kind\": \"torus\"}]").unwrap();
    expect(
        &folder.run(&["verify", "--rays", "rays.json"]),
        3,
        "rays.json: not a list of rays",
    );
    std::fs::write(&file, "[]").unwrap();
    expect(
        &folder.run(&["verify", "--rays", "rays.json"]),
        6,
        "nothing was checked",
    );
    expect(
        &folder.run(&["verify", "--rays", "none.json"]),
        3,
        "none.json: cannot read",
    );
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let script = format!("'{PROGRAM}' verify --device reference | head -n 1");
    let output = Command::new("sh").args(["-c", &script]).output().unwrap();
    expect(&output, 0, "");
    assert!(!stderr(&output).contains("error"), "{}", stderr(&output));
}
