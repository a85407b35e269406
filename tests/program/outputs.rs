//! Outputs that are no plain new files, and scenes from pipes.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::process::{Command, Output, Stdio};
use std::thread;

use crate::common::program::{Folder, PROGRAM, SCENE, expect, stderr, wait_for_the_device};
use energywave::RadianceImage;

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
const EXR: &[u8] = &[0x76, 0x2f, 0x31, 0x01];
const SMALL: [&str; 5] = ["--size", "24x16", "--device", "reference", "-q"];

fn draw(folder: &Folder, name: &str, more: &[&str]) -> Output {
    folder.render(name, &[&SMALL[..], more].concat())
}

fn mode(folder: &Folder, name: &str) -> u32 {
    let meta = fs::metadata(folder.path().join(name)).unwrap();
    meta.permissions().mode() & 0o7777
}

#[test]
fn a_pipe_and_a_device_stay_what_they_are_and_get_the_image() {
    let folder = Folder::new();
    let pipe = folder.path().join("pipe.exr");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let reader = thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).unwrap()
    });
    expect(&draw(&folder, "pipe.exr", &[]), 0, "");
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
    fs::write(folder.path().join("read.exr"), reader.join().unwrap()).unwrap();
    expect(&draw(&folder, "plain.exr", &[]), 0, "");
    let open = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
    assert_eq!(open("read.exr"), open("plain.exr"));

    let null = folder.path().join("null.png");
    symlink("/dev/null", &null).unwrap();
    for name in ["null.png", "/dev/null"] {
        expect(&draw(&folder, name, &[]), 0, "");
    }
    assert!(fs::symlink_metadata(&null).unwrap().is_symlink());
    assert!(
        fs::metadata("/dev/null")
            .unwrap()
            .file_type()
            .is_char_device()
    );
    if fs::metadata("/dev/full").is_ok() {
        expect(
            &draw(&folder, "/dev/full", &[]),
            7,
            "/dev/full: cannot write",
        );
    }
}

#[test]
fn links_are_written_through_and_files_stay_the_ones_they_are() {
    let folder = Folder::new();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("d")).unwrap();
    symlink("d/real.png", at("dangling.png")).unwrap();
    symlink("dangling.png", at("twice.png")).unwrap();
    expect(&draw(&folder, "twice.png", &[]), 0, "");
    assert!(
        fs::symlink_metadata(at("dangling.png"))
            .unwrap()
            .is_symlink()
    );
    assert!(fs::read(at("d/real.png")).unwrap().starts_with(PNG));
    symlink("none/real.png", at("nowhere.png")).unwrap();
    expect(
        &draw(&folder, "nowhere.png", &[]),
        7,
        "there is no folder none; create it first",
    );
    symlink("loop.png", at("loop.png")).unwrap();
    expect(&draw(&folder, "loop.png", &[]), 7, "loop.png: cannot write");

    for (name, bits) in [("group.png", 0o660), ("all.png", 0o604), ("run.png", 0o711)] {
        fs::write(at(name), "old").unwrap();
        fs::set_permissions(at(name), fs::Permissions::from_mode(bits)).unwrap();
        expect(&draw(&folder, name, &[]), 0, "");
        assert_eq!(mode(&folder, name), bits, "{name}");
        assert!(fs::read(at(name)).unwrap().starts_with(PNG), "{name}");
    }
    fs::hard_link(at("group.png"), at("other.png")).unwrap();
    fs::write(at("group.png"), vec![0; 100_000]).unwrap();
    let before = fs::metadata(at("other.png")).unwrap().ino();
    expect(&draw(&folder, "group.png", &[]), 0, "");
    assert_eq!(fs::metadata(at("group.png")).unwrap().ino(), before);
    assert_eq!(
        fs::read(at("group.png")).unwrap(),
        fs::read(at("other.png")).unwrap()
    );
    assert_eq!(
        fs::read(at("other.png")).unwrap(),
        fs::read(at("all.png")).unwrap()
    );

    let script = format!(
        "umask 027; exec '{PROGRAM}' render '{SCENE}' -o new.png {}",
        SMALL.join(" ")
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output();
    expect(&output.unwrap(), 0, "");
    assert_eq!(mode(&folder, "new.png"), 0o640);
}

#[test]
fn what_cannot_be_written_is_refused_before_the_work() {
    let folder = Folder::new();
    let large = ["--size", "16000x16000", "--device", "reference"];
    let refused = |name: &str, words: &str| {
        expect(&folder.render(name, &large), 7, words);
    };
    refused(&format!("{}.png", "x".repeat(300)), "File name too long");
    fs::write(folder.path().join("file"), "").unwrap();
    refused("file/out.png", "Not a directory");
    refused("out.png/", "it is a folder");
    // As long as a name may be: nothing longer is made beside it.
    let longest = format!("{}.png", "x".repeat(251));
    expect(&draw(&folder, &longest, &[]), 0, "");
    expect(&draw(&folder, &longest, &[]), 0, "");
    let mut names = folder.names();
    names.sort();
    assert_eq!(names, ["file", longest.as_str()]);
    let frames = folder.run(&["bench", SCENE, "--frames-out", "/proc", "--seconds", "0"]);
    expect(&frames, 7, "frame.exr: cannot write");
}

#[test]
fn a_killed_program_leaves_nothing() {
    let folder = Folder::new();
    fs::write(folder.path().join("old.png"), "old").unwrap();
    for name in ["out.png", "old.png"] {
        let mut child = folder
            .command()
            .args([
                "render",
                SCENE,
                "-o",
                name,
                "--device",
                "reference",
                "--size",
                "8000x8000",
            ])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        wait_for_the_device(&mut child);
        child.kill().unwrap();
        assert_eq!(child.wait().unwrap().code(), None);
        assert_eq!(folder.names(), ["old.png"]);
        assert_eq!(fs::read(folder.path().join("old.png")).unwrap(), b"old");
    }
}

/// Runs the program in the folder with this on its standard input.
fn piped(folder: &Folder, input: &[u8], arguments: &[&str]) -> Output {
    let mut child = folder
        .command()
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(input).unwrap();
    drop(stdin);
    child.wait_with_output().unwrap()
}

#[test]
fn scenes_come_from_pipes_and_images_go_to_them() {
    let folder = Folder::new();
    let scene = fs::read(SCENE).unwrap();
    expect(&draw(&folder, "a.png", &[]), 0, "");
    expect(&draw(&folder, "a.exr", &[]), 0, "");
    let png = fs::read(folder.path().join("a.png")).unwrap();
    assert!(png.starts_with(PNG));
    for (input, output, format) in [
        ("-", "-", None),
        ("/dev/stdin", "/dev/stdout", None),
        ("/dev/fd/0", "/dev/fd/1", Some("png")),
        (SCENE, "-", Some("png")),
    ] {
        let mut arguments = vec!["render", input, "-o", output];
        arguments.extend(SMALL);
        arguments.extend(format.iter().flat_map(|format| ["--format", format]));
        let found = piped(&folder, &scene, &arguments);
        expect(&found, 0, "");
        assert_eq!(found.stdout, png, "{arguments:?}");
        arguments.extend(format.map_or(&["--format", "exr"][..], |_| &[]));
        let exr = piped(&folder, &scene, &arguments);
        assert!(
            format.is_some() || exr.stdout.starts_with(EXR),
            "{arguments:?}"
        );
    }
    expect(&draw(&folder, "b.data", &["--format", "exr"]), 0, "");
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("b.data"), read("a.exr"));

    // JSON is told by how it begins; a fault says where it stands.
    let json = energywave::Scene::from_file(SCENE)
        .unwrap()
        .to_json()
        .unwrap();
    let arguments = [&["render", "-", "-o", "-"], &SMALL[..]].concat();
    assert_eq!(piped(&folder, json.as_bytes(), &arguments).stdout, png);
    let wrong = piped(&folder, b"[camera]\neye = 1\n", &arguments);
    expect(&wrong, 3, "standard input:2:7: camera.eye");
    assert!(wrong.stdout.is_empty());
}

#[test]
fn files_that_a_piped_scene_names_are_in_the_working_folder() {
    let folder = Folder::new();
    let depth = energywave::image::DepthImage::new(
        energywave::image::ImageSize {
            width: 24,
            height: 16,
        },
        energywave::image::DepthAlong::Ray,
        vec![3.5; 24 * 16],
    );
    depth
        .unwrap()
        .save(folder.path().join("depth.exr"))
        .unwrap();
    let text = fs::read_to_string(SCENE).unwrap() + "[depth]\nfile = \"depth.exr\"\n";
    fs::write(folder.path().join("scene.toml"), &text).unwrap();
    let plain = [&["render", "scene.toml", "-o", "-"], &SMALL[..]].concat();
    let right = folder.run(&plain);
    expect(&right, 0, "");
    for input in ["-", "/dev/stdin", "/proc/self/fd/0"] {
        let arguments = [&["render", input, "-o", "-"], &SMALL[..]].concat();
        let found = piped(&folder, text.as_bytes(), &arguments);
        expect(&found, 0, "");
        assert_eq!(found.stdout, right.stdout, "{input}");
        // The same from a file in another folder.
        let mut command = folder.command();
        let file = File::open(folder.path().join("scene.toml")).unwrap();
        let found = command.args(&arguments).stdin(file).output().unwrap();
        assert_eq!(found.stdout, right.stdout, "{input}: {}", stderr(&found));
    }
}

#[test]
fn an_image_that_nobody_reads_exits_with_7() {
    let folder = Folder::new();
    let mut child = folder
        .command()
        .args([&["render", SCENE, "-o", "-"], &SMALL[..]].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    expect(&output, 7, "standard output: cannot write: Broken pipe");
}
