//! The speed tables' frames are images like any other, and `energywave bench` says what it measured.

use crate::common;
use std::process::Command;
use std::time::Duration;

use energywave::image::compare;
use energywave::papers::{
    DIVISIONS, Method2006, RESOLUTIONS, TABLE_2010, TABLE_2013, Table, beam_2006, measure,
    methods_2008, table_2006, table_2008, turned,
};
use energywave::scene::{Method, ParticleShape};
use energywave::{Device, RadianceImage, Renderer, reference};
use serde_json::Value;

/// As in tests/image/images.rs: a sample next to a core outweighs the ray's others and has few float32 digits.
const WORST_PIXEL: f64 = 5e-4;

#[test]
fn every_cells_frames_match_the_float64_simpson_rule() {
    let mut renderer = common::renderer(common::device().lanes, "");
    for table in [Table::Torus, Table::Bezier] {
        for (resolution, divisions) in [(128, 64), (128, 256), (256, 64)] {
            for frame in [0, 7, 40] {
                let scene = turned(&table.scene(resolution, divisions), frame);
                let image = renderer.render(&scene).unwrap();
                let found = common::difference(&image, &common::simpson_reference(&scene));
                assert!(
                    found.max < WORST_PIXEL,
                    "{table:?} {resolution} {divisions}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn the_measured_frame_is_the_one_it_names() {
    let mut renderer = common::renderer(common::device().lanes, "");
    let scene = Table::Torus.scene(64, 20);
    let speed = measure(&mut renderer, &scene, Duration::from_millis(20)).unwrap();
    assert_eq!(
        speed.image,
        renderer.render(&turned(&scene, speed.frame)).unwrap()
    );
    assert_ne!(
        speed.image,
        renderer.render(&turned(&scene, speed.frame + 1)).unwrap()
    );
    assert_eq!(speed.cost.integrals, 64 * 64);
    assert_eq!(speed.cost.samples, 64 * 64 * 21);
    assert!(speed.kernel > Duration::ZERO && speed.kernel.as_secs_f64() < 1.5 / speed.fps);
}

#[test]
fn mapped_read_and_returned_images_are_the_same() {
    let mut renderer = common::renderer(common::device().lanes, "");
    let scene = common::full_scene(37, 11);
    let returned = renderer.render(&scene).unwrap();
    assert_eq!(
        &*renderer.render_mapped(&scene).unwrap(),
        returned.as_slice()
    );
    let mut read = vec![0.0; 4 * 37 * 11];
    renderer.render_into(&scene, &mut read).unwrap();
    assert_eq!(read, returned.as_slice());
    assert!(renderer.render_into(&scene, &mut read[1..]).is_err());
}

#[test]
fn rows_go_where_the_caller_wants_them_and_nothing_between_is_touched() {
    let scene = common::full_scene(37, 11);
    let reference = Device::reference();
    let renderers = [
        common::renderer(common::device().lanes, ""),
        Renderer::new(&reference).unwrap(),
    ];
    for mut renderer in renderers {
        let image = renderer.render(&scene).unwrap();
        for stride in [4 * 37, 4 * 37 + 1, 4 * 64] {
            let mut target = vec![-7.0; 11 * stride + 5];
            renderer
                .render_rows(&scene, 0..11, &mut target, stride)
                .unwrap();
            let rows = image.as_slice().chunks(4 * 37);
            for (found, expected) in target.chunks(stride).zip(rows) {
                assert_eq!(&found[..4 * 37], expected);
                assert!(found[4 * 37..].iter().all(|value| *value == -7.0));
            }
            assert!(target[11 * stride..].iter().all(|value| *value == -7.0));
            // The last row needs nothing behind it.
            let least = 10 * stride + 4 * 37;
            assert!(
                renderer
                    .render_rows(&scene, 0..11, &mut target[..least], stride)
                    .is_ok()
            );
            let short = renderer.render_rows(&scene, 0..11, &mut target[..least - 1], stride);
            let message = short.unwrap_err().to_string();
            assert!(
                message.contains(&format!("and {least} in all")),
                "{message}"
            );
        }
        assert!(
            renderer
                .render_rows(&scene, 0..11, &mut [0.0; 4096], 4 * 36)
                .is_err()
        );
    }
}

/// Runs `energywave bench` in a fresh folder: its JSON, and the folder.
fn bench(arguments: &[&str]) -> (Value, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_energywave"))
        .args([
            "bench",
            "--json",
            "--seconds",
            "0.01",
            "--frames-out",
            "frames",
        ])
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    (serde_json::from_slice(&output.stdout).unwrap(), folder)
}

#[test]
fn a_table_has_nine_cells_with_their_frames() {
    let (cells, folder) = bench(&["--table", "2"]);
    let cells = cells.as_array().unwrap();
    assert_eq!(cells.len(), 9);
    for (cell, (i, j)) in cells
        .iter()
        .zip((0..3).flat_map(|i| (0..3).map(move |j| (i, j))))
    {
        assert_eq!(
            (&cell["table"], &cell["field"]),
            (&2.into(), &"torus".into())
        );
        assert_eq!(cell["resolution"], RESOLUTIONS[i]);
        assert_eq!(cell["divisions"], DIVISIONS[j]);
        let ratio = cell["fps"].as_f64().unwrap() / cell["paper_fps"].as_f64().unwrap();
        assert!((cell["ratio"].as_f64().unwrap() / ratio - 1.0).abs() < 1e-9);
    }
    let cell = &cells[1];
    let scene = Table::Torus.scene(128, 128);
    let scene = turned(&scene, cell["frame"].as_u64().unwrap() as u32);
    let frame = RadianceImage::open(folder.path().join("frames/torus-128-128.exr")).unwrap();
    let found = compare(&frame, &common::simpson_reference(&scene)).unwrap();
    assert!(found.max < WORST_PIXEL, "{found:?}");
}

#[test]
fn the_table_of_2010_has_four_cells_and_a_comparison() {
    let (cells, folder) = bench(&["--table", "2010"]);
    let cells = cells.as_array().unwrap();
    assert_eq!(cells.len(), 4);
    for (cell, known) in cells.iter().zip(TABLE_2010) {
        assert_eq!(
            (&cell["table"], &cell["field"]),
            (&2010.into(), &"beam".into())
        );
        assert_eq!(cell["resolution"], known.resolution);
        assert_eq!(cell["depth"], known.has_depth);
        assert_eq!(cell["paper_fps"], known.paper_fps);
        assert!(cell["tiles_fps"].as_f64().unwrap() > 0.0);
        let ratio = cell["fps"].as_f64().unwrap() / known.paper_fps;
        assert!((cell["ratio"].as_f64().unwrap() / ratio - 1.0).abs() < 1e-9);
    }
    assert!(cells[3]["single_threaded_fps"].as_f64().unwrap() > 0.0);
    assert_eq!(cells[3]["paper_single_threaded_fps"], 1.0);
    assert!(cells[0]["single_threaded_fps"].is_null());
    let frame = cells[1]["frame"].as_u64().unwrap() as u32;
    let scene = turned(&TABLE_2010[1].scene().unwrap(), frame);
    let image = RadianceImage::open(folder.path().join("frames/beam-256-depth.exr")).unwrap();
    let found = compare(&image, &reference::render(&scene).unwrap()).unwrap();
    assert!(common::meets(&found, 1e-3), "{found:?}");
}

#[test]
fn a_scene_is_measured_with_its_overrides() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/figure-09.toml");
    let (record, folder) = bench(&[scene, "--size", "32x16", "--divisions", "10"]);
    assert_eq!(record["width"], 32);
    assert_eq!(record["height"], 16);
    assert_eq!(record["method"], "simpson");
    assert_eq!(record["sampling"], "pixels");
    assert_eq!(record["evaluations"], 2 * 32 * 16);
    assert_eq!(record["field_evaluations"], 2 * 32 * 16 * 11);
    assert!(record["fps"].as_f64().unwrap() > 0.0);
    assert!(folder.path().join("frames/figure-09.exr").exists());
}

#[test]
fn a_bench_of_nothing_that_exists_is_refused() {
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_energywave"))
            .arg("bench")
            .args(arguments)
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    assert_eq!(run(&["--table", "4"]).0, Some(2));
    assert_eq!(run(&["--table", "2007"]).0, Some(2));
    let (code, message) = run(&["--divisions", "64"]);
    assert_eq!(code, Some(2));
    assert!(message.contains("SCENE"), "{message}");
    let (code, message) = run(&["--table", "2", "--size", "64x64"]);
    assert_eq!(code, Some(2));
    assert!(message.contains("of their own"), "{message}");
    assert_eq!(run(&["nowhere.toml"]).0, Some(3));
}

#[test]
fn a_cell_of_2008_says_what_is_hit_and_what_samples_miss() {
    let mut renderer = common::renderer(common::device().lanes, "");
    let mut options = common::options(common::device().lanes, "");
    options.counts_samples = true;
    let mut counting = Renderer::with_options(&common::device(), &options).unwrap();
    let cell = table_2008()[0];
    let [exact, few, many] = methods_2008().map(|method| {
        let found = cell
            .measure((&mut renderer, &mut counting), method, Duration::ZERO)
            .unwrap();
        assert!(found.speed.fps > 0.0 && found.sort > Duration::ZERO);
        assert!(found.sort < found.speed.times.greatest);
        assert!(found.passes > 1.0 && found.pairs > found.passes);
        (found.hit, found.holes)
    });
    assert!((0.1..0.4).contains(&exact.0) && exact.1 == 0.0, "{exact:?}");
    assert!(
        few.0 == exact.0 && few.1 > 0.0 && many.1 <= few.1,
        "{few:?} {many:?}"
    );
}

#[test]
fn a_cell_of_2013_has_its_particles_and_another_step_in_every_frame() {
    let mut renderer = common::renderer(common::device().lanes, "");
    let cell = TABLE_2013[2];
    let [sprites, streaks] = [ParticleShape::Sprites, ParticleShape::Streaks].map(|shape| {
        let found = cell.measure(&mut renderer, shape, Duration::ZERO).unwrap();
        assert!(found.speed.fps > 0.0 && found.simulation > Duration::ZERO);
        assert!(found.particles.abs_diff(1221) < 60, "{}", found.particles);
        found.elements
    });
    assert!(sprites > 3 * streaks, "{sprites} {streaks}");
    let mut frame = |frame| {
        renderer
            .render(&cell.scene(ParticleShape::Streaks, frame))
            .unwrap()
    };
    assert!(frame(120).as_slice() != frame(121).as_slice());
}

/// What few cells leave of the beam of 2006, the mean over its light.
const OF_CELLS: f32 = 0.15;

#[test]
fn the_ways_of_2006_draw_the_same_beam_and_a_billboard_only_from_before_it() {
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let mut renderer = common::renderer(common::device().lanes, "");
    let texture = beam_2006(&mut reference, 64).unwrap();
    assert_eq!(table_2006().len(), 20);
    let scene = |method, height| {
        let mut cells = table_2006().into_iter();
        let cell = cells.find(|cell| cell.cells <= 64 && cell.method == method);
        let mut scene = cell.unwrap().scene(&texture);
        (scene.image.width, scene.image.height) = (32, 32);
        scene.integration.method = Method::default();
        scene.camera.eye.z = height;
        scene
    };
    for height in [0.0, 12.0] {
        let truth = reference
            .render(&scene(Method2006::RayCasting, height))
            .unwrap();
        let light: f32 = truth.as_slice().iter().step_by(4).sum();
        for (method, is_same) in [
            (Method2006::Slices, true),
            (Method2006::Rays, true),
            (Method2006::Billboard, height == 0.0),
        ] {
            let image = renderer.render(&scene(method, height)).unwrap();
            let pairs = image.as_slice().iter().zip(truth.as_slice()).step_by(4);
            let off = pairs
                .map(|(found, light)| (found - light).abs())
                .sum::<f32>()
                / light;
            println!("{method:?} from {height}: {off:.3}");
            assert_eq!(off < OF_CELLS, is_same, "{method:?} from {height}: {off}");
        }
    }
}
