//! What the program says and does where OpenCL is missing, broken, or ambiguous.

use crate::common;
use std::path::PathBuf;

use crate::common::program::{Folder, SCENE, device, expect, stderr};
use serde_json::Value;

/// A folder with a file `libOpenCL.so.1` that is no library: the loader is there and cannot be loaded.
fn without_loader(folder: &Folder) -> PathBuf {
    let path = folder.path().join("libraries");
    std::fs::create_dir(&path).unwrap();
    std::fs::write(path.join("libOpenCL.so.1"), "no library").unwrap();
    path
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
    if common::device().platform == "Portable Computing Language" {
        let both = variable("POCL_DEVICES", "pthread pthread", &["--device", "pthread"]);
        expect(&both, 4, "fits 2 devices");
        assert!(stderr(&both).contains("0: pthread") && stderr(&both).contains("1: pthread"));
    } else {
        println!("only PoCL can show one device twice: not checked here");
    }
    assert!(folder.names().is_empty());
    expect(
        &variable("ENERGYWAVE_DEVICE", "voodoo", &["--device", "reference"]),
        0,
        "reference",
    );
}

#[test]
fn without_opencl_the_reference_draws_and_a_warning_says_what_to_install() {
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
        let said = stderr(&output);
        let lines: Vec<&str> = said.lines().collect();
        // A warning, the device, and what was drawn.
        assert_eq!(lines.len(), 3, "{said}");
        assert!(
            lines[0].starts_with("warning: ") && lines[0].contains("hundreds of times slower"),
            "{said}"
        );
        assert!(
            lines[1].starts_with("device: ") && lines[1].contains("reference"),
            "{said}"
        );
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
fn a_driver_that_cannot_be_loaded_is_named_with_what_it_lacks() {
    let folder = Folder::new();
    let vendors = folder.path().join("vendors");
    std::fs::create_dir(&vendors).unwrap();
    std::fs::write(vendors.join("a.icd"), "/nowhere/libdriver.so\n").unwrap();
    for arguments in [
        &["render", SCENE, "-o", "out.png", "--size", "8x8"][..],
        &["devices"],
    ] {
        let mut command = folder.command();
        let output = command
            .args(arguments)
            .env("OCL_ICD_VENDORS", &vendors)
            .output()
            .unwrap();
        expect(
            &output,
            0,
            "a.icd names the driver /nowhere/libdriver.so, which cannot be loaded (",
        );
        expect(&output, 0, "No such file");
    }
}

#[test]
fn pocl_draws_without_a_path_and_without_a_folder_for_its_cache() {
    if common::device().platform != "Portable Computing Language" {
        println!("only PoCL needs them: not checked here");
        return;
    }
    let folder = Folder::new();
    let own = folder.path().join("run");
    std::fs::create_dir(&own).unwrap();
    let draw = |variables: &[(&str, &str)]| {
        let mut command = folder.command();
        command.args([
            "render",
            SCENE,
            "-o",
            "out.png",
            "--size",
            "8x8",
            "--device",
            device(),
        ]);
        command.env_clear().env("XDG_RUNTIME_DIR", &own);
        command.envs(variables.iter().copied()).output().unwrap()
    };
    // Nothing is in its cache yet: it has to link.
    let bare = draw(&[]);
    expect(&bare, 0, "device: ");
    assert_eq!(stderr(&bare).lines().count(), 2, "{}", stderr(&bare)); // the device, and what was drawn
    let count = |folder: &std::path::Path| std::fs::read_dir(folder).unwrap().count();
    assert_eq!(count(&own), 1, "the kernels' folder");
    // /proc takes no folder, whoever asks.
    let home = draw(&[("HOME", "/proc/none")]);
    expect(&home, 0, "device: ");
    assert_eq!(stderr(&home).lines().count(), 2, "{}", stderr(&home));
    let chosen = draw(&[("POCL_CACHE_DIR", "/proc/none")]);
    expect(
        &chosen,
        0,
        "warning: PoCL's cache: /proc/none cannot be written (",
    );
    let usable = folder.path().join("kernels");
    expect(
        &draw(&[("POCL_CACHE_DIR", usable.to_str().unwrap())]),
        0,
        "device: ",
    );
    assert!(count(&usable) > 0, "what the user chose is used");
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
    let line = 1 + include_str!("../../cl/lanes.h")
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
