//! A first launch that does not end is told, once; nothing is left of who watched.

use std::sync::Mutex;
use std::time::Duration;

use crate::common;
use crate::common::apart::apart;
use energywave::{Renderer, RendererOptions, SlowStart};

static TOLD: Mutex<Vec<String>> = Mutex::new(Vec::new());

fn tell(message: &str) {
    TOLD.lock().unwrap().push(message.to_owned());
}

fn told() -> Vec<String> {
    std::mem::take(&mut *TOLD.lock().unwrap())
}

fn renderer(after: Duration) -> Renderer {
    let mut options = RendererOptions::default();
    options.slow_start = Some(SlowStart { after, tell });
    Renderer::with_options(&common::device(), &options).unwrap()
}

/// Threads of this process.
#[cfg(target_os = "linux")]
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").unwrap().count()
}

#[test]
fn a_start_slower_than_is_allowed_is_told_once_with_device_and_driver() {
    apart(&[], || {
        let scene = common::full_scene(16, 16);
        let mut renderer = renderer(Duration::ZERO);
        renderer.render(&scene).unwrap();
        let found = told();
        assert_eq!(found.len(), 1, "{found:?}");
        let device = common::device();
        for words in [
            &device.name,
            &device.driver,
            "first launch",
            "choose another device",
        ] {
            assert!(found[0].contains(words), "{found:?}");
        }
        renderer.render(&scene).unwrap();
        assert_eq!(told(), [""; 0], "kernels that are there start no watch");
    });
}

#[test]
fn a_start_within_what_is_allowed_is_not_told_and_leaves_no_thread() {
    apart(&[], || {
        let scene = common::full_scene(16, 16);
        let mut renderer = renderer(Duration::from_secs(3600));
        renderer.render(&scene).unwrap();
        #[cfg(target_os = "linux")]
        {
            let before = threads();
            let mut other = scene.clone();
            other.integration.method = energywave::scene::Method::simpson(8);
            renderer.render(&other).unwrap();
            assert_eq!(threads(), before, "a thread was left over");
        }
        drop(renderer);
        assert_eq!(told(), [""; 0]);
    });
}
