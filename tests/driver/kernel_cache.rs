//! Kernels kept on disk: the next start takes them, and whatever is wrong with folder or files, the image is right.
//! Spoiled: an entry with a valid seal over other kernels must spoil the image.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::BROKEN_FIELDS;
use crate::common::program::{Folder, SCENE, device, expect};
use sha2::{Digest, Sha256};

/// What stands before the body of an entry: the format, and the seal.
const HEAD: usize = 8 + 32;

const RENDER: [&str; 6] = [
    "--size",
    "16x16",
    "--method",
    "simpson",
    "--divisions",
    "64",
];

/// A command that renders to `out.exr` with the kernels kept in a folder, on every driver.
fn command(folder: &Folder, cache: &Path) -> Command {
    let mut command = folder.command();
    command.args(["render", SCENE, "-o", "out.exr", "--device", device()]);
    command.args(RENDER).arg("--no-self-test"); // which keeps entries of its own
    command.env("ENERGYWAVE_CACHE", "always");
    command.env("ENERGYWAVE_CACHE_DIR", cache);
    command
}

fn image(folder: &Folder, output: &Output) -> Vec<u8> {
    expect(output, 0, "");
    let path = folder.path().join("out.exr");
    let image = fs::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    image
}

fn render(folder: &Folder, cache: &Path) -> Vec<u8> {
    image(folder, &command(folder, cache).output().unwrap())
}

fn render_spoiled(folder: &Folder, cache: &Path) -> Vec<u8> {
    let mut command = command(folder, cache);
    command.env("ENERGYWAVE_BUILD_OPTIONS", BROKEN_FIELDS);
    image(folder, &command.output().unwrap())
}

/// The one entry of a folder.
fn entry(cache: &Path) -> PathBuf {
    let files = fs::read_dir(cache).unwrap();
    let mut paths: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    assert_eq!(paths.len(), 1, "{paths:?}");
    let path = paths.remove(0);
    assert!(path.extension().unwrap() == "bin");
    path
}

/// An entry for a key, which its name tells, with another body.
fn sealed(path: &Path, format: &[u8], body: &[u8]) -> Vec<u8> {
    let name = path.file_stem().unwrap().to_str().unwrap();
    let digits = |at: usize| u8::from_str_radix(&name[at..at + 2], 16).unwrap();
    let key: Vec<u8> = (0..64).step_by(2).map(digits).collect();
    let kind = [&3_u64.to_le_bytes()[..], b"bin"].concat();
    let seal = Sha256::digest([format, &key, &kind, body].concat());
    [format, &seal, body].concat()
}

#[test]
fn the_second_start_takes_the_kept_kernels_and_draws_the_same_image() {
    let folder = Folder::new();
    let (cache, spoiled) = (folder.path().join("a"), folder.path().join("b"));
    let first = render(&folder, &cache);
    let path = entry(&cache);
    let written = fs::read(&path).unwrap();
    assert_eq!(written, sealed(&path, &written[..8], &written[HEAD..]));
    assert_eq!(render(&folder, &cache), first);
    assert_eq!(fs::read(entry(&cache)).unwrap(), written);

    // Whoever built from source would draw the right image here.
    let wrong = render_spoiled(&folder, &spoiled);
    assert_ne!(wrong, first);
    let other = fs::read(entry(&spoiled)).unwrap();
    fs::write(&path, sealed(&path, &other[..8], &other[HEAD..])).unwrap();
    assert_eq!(render(&folder, &cache), wrong);

    // The same kernels with the seal of their own key are refused, and replaced.
    fs::write(&path, &other).unwrap();
    assert_eq!(render(&folder, &cache), first);
    let replaced = fs::read(&path).unwrap();
    assert_eq!(replaced, sealed(&path, &replaced[..8], &replaced[HEAD..]));
    assert_eq!(render(&folder, &cache), first);
}

#[test]
fn a_damaged_entry_is_built_again_and_replaced() {
    let folder = Folder::new();
    let cache = folder.path().join("cache");
    let right = render(&folder, &cache);
    let path = entry(&cache);
    let good = fs::read(&path).unwrap();
    let (length, middle) = (good.len(), good.len() / 2);
    let mut damaged: Vec<Vec<u8>> = [0, 7, HEAD - 1, HEAD, HEAD + 1, middle, length - 1]
        .iter()
        .map(|at| good[..*at].to_vec())
        .collect();
    for at in [0, 7, 8, HEAD - 1, HEAD, middle, length - 1] {
        let mut bytes = good.clone();
        bytes[at] ^= 1;
        damaged.push(bytes);
    }
    damaged.push([0x5a; 5000].to_vec());
    // The seal fits, the driver refuses.
    damaged.push(sealed(&path, &good[..8], b"no program"));
    damaged.push(sealed(&path, &good[..8], b""));
    let replaced = |what: &str| {
        assert_eq!(render(&folder, &cache), right, "{what}");
        let bytes = fs::read(entry(&cache)).unwrap();
        assert!(bytes == sealed(&path, &good[..8], &bytes[HEAD..]), "{what}");
        assert!(bytes.len() > length / 2, "{what}: {}", bytes.len());
    };
    for (index, bytes) in damaged.iter().enumerate() {
        fs::write(&path, bytes).unwrap();
        replaced(&format!("damage {index}, {} bytes", bytes.len()));
    }
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    replaced("a folder in its place");
}

#[test]
fn without_a_usable_folder_the_kernels_are_built() {
    let folder = Folder::new();
    let cache = folder.path().join("cache");
    let right = render(&folder, &cache);
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for unusable in [&file, &file.join("below")] {
        assert_eq!(render(&folder, unusable), right, "{}", unusable.display());
    }
}

#[test]
fn programs_at_once_share_a_folder() {
    let folders: Vec<Folder> = (0..3).map(|_| Folder::new()).collect();
    let cache = folders[0].path().join("cache");
    let start = |folder| command(folder, &cache).spawn().unwrap();
    let running: Vec<_> = folders.iter().map(start).collect();
    let finish = |(folder, child): (&Folder, std::process::Child)| {
        image(folder, &child.wait_with_output().unwrap())
    };
    let images: Vec<_> = folders.iter().zip(running).map(finish).collect();
    assert!(images.windows(2).all(|pair| pair[0] == pair[1]));
    assert_eq!(render(&folders[0], &cache), images[0]);
    entry(&cache);
}

#[test]
fn never_means_never() {
    let folder = Folder::new();
    let cache = folder.path().join("cache");
    let mut command = command(&folder, &cache);
    expect(
        &command.env("ENERGYWAVE_CACHE", "never").output().unwrap(),
        0,
        "",
    );
    assert!(!cache.exists());
}
