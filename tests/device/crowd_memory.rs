//! What crowds take of memory: as they say, as docs/scenes.md states it, and as the process has it.

use energywave::papers::{crowd, depths_of_boxes};
use energywave::scene::{Method, Profile};
use energywave::{Renderer, Scene};

use crate::common;

/// What the list has of each point: a position of float64, and its light of float32.
const OF_LIST: u64 = 36;

const MILLION: u32 = 1_000_000;

/// Bytes a million points take at 1920x1080, a point, and the list with them: of a vertical angle of view, behind so
/// many boxes.
const STATED: [(f64, u32, Profile, u64); 8] = [
    (45.0, 0, Profile::Inverse, 170),
    (45.0, 0, Profile::InverseSquare, 190),
    (10.0, 0, Profile::Inverse, 160),
    (10.0, 0, Profile::InverseSquare, 170),
    (2.0, 0, Profile::Inverse, 215),
    (2.0, 0, Profile::InverseSquare, 220),
    (45.0, 100, Profile::Inverse, 490),
    (45.0, 100, Profile::InverseSquare, 600),
];

fn scene(count: u32, fov_y: f64, boxes: u32, profile: Profile) -> Scene {
    let mut scene = crowd(count, profile).unwrap();
    scene.camera.fov_y = fov_y;
    if boxes > 0 {
        scene.depth = Some(depths_of_boxes(&scene, boxes).unwrap());
    }
    scene
}

/// Returns what a crowd takes when it is the first that is drawn.
fn bytes(scene: &Scene) -> u64 {
    let mut renderer = Renderer::new(&common::device()).unwrap();
    renderer.render_mapped(scene).unwrap();
    renderer.last_cost().crowds.bytes
}

#[test]
fn a_million_points_take_as_much_as_is_stated() {
    let mut others = Vec::new();
    for (fov_y, boxes, profile, stated) in STATED {
        let all = bytes(&scene(MILLION, fov_y, boxes, profile));
        let each = all / u64::from(MILLION) + OF_LIST;
        let name =
            format!("{fov_y} degrees, {boxes} boxes, {profile:?}: {all} bytes, {each} a point");
        println!("{name}");
        if !(stated * 9 / 10..=stated).contains(&each) {
            others.push(format!("{name}; {stated} are stated"));
        }
    }
    assert_eq!(others, Vec::<String>::new());
}

/// Cells and tiles take the same of fewer points; what has more nodes takes more.
#[test]
fn fewer_points_take_less_and_tight_tolerances_more() {
    let million = bytes(&scene(MILLION, 45.0, 0, Profile::Inverse));
    let mut fewer = scene(MILLION / 10, 45.0, 0, Profile::Inverse);
    let found = bytes(&fewer);
    let a_point = (million - found) / u64::from(MILLION / 10 * 9);
    println!("{found} bytes of a hundred thousand, {a_point} a point more");
    assert!((75..=100).contains(&a_point), "{a_point} bytes a point");
    fewer.integration.method = Method::exact(1e-4);
    let tight = bytes(&fewer);
    assert!(tight > found / 10 * 15, "{tight} bytes, {found} of 1e-3");
}

/// What the process takes of memory when it first draws a million points is no more than what they say they take: on
/// CPUs buffers are its own. Pages of theirs that nobody writes are not there.
#[cfg(target_os = "linux")]
#[test]
fn a_process_takes_no_more_than_its_crowd_says() {
    fn most_resident() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find(|line| line.starts_with("VmHWM:"));
        let words = line.unwrap().split_whitespace().nth(1);
        words.unwrap().parse::<u64>().unwrap() << 10
    }
    common::apart::apart(&[], || {
        let few = scene(1000, 45.0, 0, Profile::Inverse);
        let many = scene(MILLION, 45.0, 0, Profile::Inverse);
        let mut renderer = Renderer::new(&common::device()).unwrap();
        let mut draw = |scene| {
            renderer.render_mapped(scene).unwrap();
            (renderer.last_cost().crowds.bytes, most_resident())
        };
        // The kernels are built by then.
        let (said_before, before) = draw(&few);
        let (said, after) = draw(&many);
        let (more, grown) = (said - said_before, after - before);
        println!("{more} bytes more, as it says, {grown} of the process");
        assert!(grown < more + (8 << 20), "{grown} bytes, {more} are said");
        assert!(grown > more / 2, "{grown} bytes, {more} are said");
    });
}
