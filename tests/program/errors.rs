//! Errors for programs: a kind and a code for each, and what another library said; and options that no kernel can be
//! built for.

use std::collections::HashSet;
use std::error::Error as _;

use crate::common;
use energywave::image::{ImageFormat, ImageSize};
use energywave::{Device, Error, ErrorKind, RadianceImage, Renderer, RendererOptions, Scene};

const KINDS: [ErrorKind; 12] = [
    ErrorKind::Scene,
    ErrorKind::Input,
    ErrorKind::Unsupported,
    ErrorKind::NoSuchDevice,
    ErrorKind::Build,
    ErrorKind::SelfTest,
    ErrorKind::Device,
    ErrorKind::Host,
    ErrorKind::OutOfMemory,
    ErrorKind::OutputFormat,
    ErrorKind::Output,
    ErrorKind::Interrupted,
];

#[test]
fn codes_are_distinct_and_in_the_form_of_keys() {
    let codes: HashSet<&str> = KINDS.iter().map(|kind| kind.code()).collect();
    assert_eq!(codes.len(), KINDS.len(), "{codes:?}");
    for code in codes {
        let is_key = |c: char| c.is_ascii_lowercase() || c == '-';
        assert!(!code.is_empty() && code.chars().all(is_key), "{code}");
    }
}

/// One error of each kind that needs no broken driver.
fn errors() -> Vec<(ErrorKind, &'static str, Error)> {
    let scene = common::empty_scene(8, 8);
    let mut invalid = scene.clone();
    invalid.camera.near = -1.0;
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("none");
    let huge = ImageSize {
        width: u32::MAX,
        height: u32::MAX / 64,
    };
    let image = RadianceImage::new(scene.image).unwrap();
    let mut renderer = Renderer::new(&Device::reference()).unwrap();
    let stop = &mut |_: f32| std::ops::ControlFlow::Break(());
    let interrupted = renderer.render_with_progress(&scene, stop);
    vec![
        (ErrorKind::Scene, "scene", invalid.validate().unwrap_err()),
        (
            ErrorKind::Input,
            "input",
            Scene::from_file(nowhere.join("a.toml")).unwrap_err(),
        ),
        (
            ErrorKind::Unsupported,
            "unsupported",
            Renderer::on_devices(&[], &RendererOptions::default()).unwrap_err(),
        ),
        (
            ErrorKind::NoSuchDevice,
            "no-such-device",
            Device::select("voodoo").unwrap_err(),
        ),
        (
            ErrorKind::OutOfMemory,
            "out-of-memory",
            RadianceImage::new(huge).unwrap_err(),
        ),
        (
            ErrorKind::OutputFormat,
            "output-format",
            ImageFormat::of("picture.gif".as_ref()).unwrap_err(),
        ),
        (
            ErrorKind::Output,
            "output",
            image
                .save(nowhere.join("a.png"), &scene.display)
                .unwrap_err(),
        ),
        (
            ErrorKind::Interrupted,
            "interrupted",
            interrupted.unwrap_err(),
        ),
    ]
}

#[test]
fn every_error_has_the_code_of_its_kind_and_no_word_of_the_command_line() {
    for (kind, code, error) in errors() {
        assert_eq!((error.kind(), error.code()), (kind, code), "{error}");
        assert!(!error.to_string().contains("--"), "{error}");
    }
}

#[test]
fn a_file_that_is_not_there_has_the_systems_error_as_its_source() {
    let error = Scene::from_file("nowhere/a.toml").unwrap_err();
    let source = error.source().unwrap();
    let system = source.downcast_ref::<std::io::Error>().unwrap();
    assert_eq!(system.kind(), std::io::ErrorKind::NotFound);
    let scene = Scene::from_toml("[camera]\n").unwrap_err();
    assert!(scene.source().is_none(), "{scene}");
}

#[test]
fn options_that_no_kernel_can_be_built_for_are_refused_before_a_frame() {
    let device = common::device();
    let with = |lanes, workers| {
        let mut options = RendererOptions::default();
        (options.lanes, options.tile_workers) = (lanes, workers);
        Renderer::with_options(&device, &options)
    };
    for lanes in [0, 2, 3, 32, u32::MAX] {
        let error = with(Some(lanes), None).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        let words = format!("{lanes} lanes; 1, 4, 8 or 16");
        assert!(error.to_string().contains(&words), "{error}");
    }
    for workers in [0, 3, 64] {
        let error = with(None, Some(workers)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        let words = format!("{workers} work-items a tile; 1, 2, 4, 8, 16 or 32");
        assert!(error.to_string().contains(&words), "{error}");
    }
    // Twice: a list of devices asks each.
    let mut options = RendererOptions::default();
    options.lanes = Some(3);
    let devices = [device.clone(), device.clone()];
    let error = Renderer::on_devices(&devices, &options).unwrap_err();
    assert!(error.to_string().contains("3 lanes"), "{error}");
    assert!(with(Some(4), Some(4)).is_ok() && with(None, None).is_ok());
}

#[test]
fn the_reference_is_no_best_device_and_is_there_without_a_search() {
    assert_eq!(Device::reference().name, "reference");
    let best = Device::best().unwrap();
    assert_ne!(best.name, "reference");
    let devices = energywave::Devices::discover();
    assert_eq!(devices.best_or_reference().name, best.name);
}
