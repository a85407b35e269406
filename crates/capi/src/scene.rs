//! Scenes: read from a file or a text, at a time, with some of their values replaced.

use std::ffi::c_char;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use energywave::scene::AnimatedScene;
use energywave::{Scene, SceneError};

use crate::border::{self, Out, Versioned};
use crate::device::give_text;
use crate::override_values::Overrides;
use crate::registry;
use crate::status::{Outcome, Status, guarded};
use energywave::scene::Overrides as Values;

/// A scene.
#[allow(dead_code, reason = "C knows it by its name alone")]
pub struct SceneHandle;

/// A scene that was read, and what it is at its time.
pub struct SceneState {
    read: AnimatedScene,
    values: Values,
    time: f64,
    scene: Arc<Scene>,
    warnings: Vec<SceneError>,
}

/// What a scene is.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct SceneInfo {
    /// `sizeof` of this struct, set by the caller.
    pub struct_size: usize,
    /// Width of the image, pixels.
    pub width: u32,
    /// Height of the image, pixels.
    pub height: u32,
    /// Sources of light.
    pub sources: u64,
    /// The time that it shows, seconds.
    pub time: f64,
    /// After how many seconds it begins again; 0: it does not say.
    pub period: f64,
    /// 1 if something of it changes over time, else 0.
    pub is_animated: u32,
    /// How many lines energywave_scene_warnings has.
    pub warnings: u32,
}

// SAFETY: it begins with its size, and its fields are numbers.
unsafe impl Versioned for SceneInfo {}

impl SceneState {
    fn new(read: AnimatedScene) -> Outcome<Self> {
        let (scene, warnings) = read.at_with_warnings(0.0, |_, _| Ok(()))?;
        Ok(Self {
            read,
            values: Values::default(),
            time: 0.0,
            scene: Arc::new(scene),
            warnings,
        })
    }

    /// Shows another time, with other values; a fault leaves everything as it was.
    fn change(&mut self, values: Values, time: f64) -> Outcome {
        let adjust = |scene: &mut Scene, keys: &_| values.apply(scene, keys);
        let (scene, warnings) = self.read.at_with_warnings(time, adjust)?;
        self.scene = Arc::new(scene);
        (self.values, self.time, self.warnings) = (values, time, warnings);
        Ok(())
    }
}

/// Returns what a scene is now. It stays so for the call, whatever other threads do.
pub fn scene_of(handle: *const SceneHandle) -> Outcome<Arc<Scene>> {
    let kept: Arc<Mutex<SceneState>> = registry::find(handle)?;
    let state = registry::lock(&kept)?;
    Ok(Arc::clone(&state.scene))
}

fn give(read: AnimatedScene, scene: Out<'_, *mut SceneHandle>) -> Outcome {
    scene.set(registry::keep(SceneState::new(read)?));
    Ok(())
}

/// Reads a scene file; the ending chooses: `.json` is JSON, everything else TOML. `*scene` is freed by
/// energywave_scene_free; where the call fails, it stays as it was.
///
/// # Safety
/// `path` ends with a 0; `scene` points to a place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_scene_from_file(
    path: *const c_char,
    scene: *mut *mut SceneHandle,
) -> Status {
    guarded(|| {
        // SAFETY: the caller's promise, twice.
        let (path, scene) = unsafe { (border::file(path, "path")?, border::out(scene, "scene")?) };
        give(AnimatedScene::from_file(path)?, scene)
    })
}

/// Reads a scene in UTF-8, JSON if it begins with `{`, else TOML. Files that it names are from `folder`; NULL: from the
/// working folder. `*scene` is as of energywave_scene_from_file.
///
/// # Safety
/// `text` ends with a 0, `folder` too or it is NULL; `scene` points to a place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_scene_from_text(
    text: *const c_char,
    folder: *const c_char,
    scene: *mut *mut SceneHandle,
) -> Status {
    guarded(|| {
        // SAFETY: the caller's promise, three times.
        let (text, scene) = unsafe { (border::text(text, "text")?, border::out(scene, "scene")?) };
        let folder = match folder.is_null() {
            true => PathBuf::new(),
            // SAFETY: the same.
            false => unsafe { border::path(folder, "folder") }?,
        };
        give(AnimatedScene::from_text(text, folder)?, scene)
    })
}

/// Frees a scene; NULL is none. Calls of other threads that use it come to their end.
#[unsafe(no_mangle)]
pub extern "C" fn energywave_scene_free(scene: *mut SceneHandle) -> Status {
    guarded(|| registry::free::<SceneState, _>(scene))
}

/// Replaces values of the scene's text, instead of those that were replaced before; NULL: by none. Where the call
/// fails, the scene stays as it was.
///
/// # Safety
/// `overrides` is NULL, or points to as many bytes as it says; its texts are NULL or end with a 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_scene_override(
    scene: *mut SceneHandle,
    overrides: *const Overrides,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<SceneState>> = registry::find(scene)?;
        let values = match overrides.is_null() {
            true => Values::default(),
            // SAFETY: the caller's promise, twice.
            false => unsafe { border::read_struct(overrides, "overrides")?.read() }?,
        };
        let mut state = registry::lock(&kept)?;
        let time = state.time;
        state.change(values, time)
    })
}

/// Goes to another time, seconds. Where the call fails, the scene stays as it was.
#[unsafe(no_mangle)]
pub extern "C" fn energywave_scene_set_time(scene: *mut SceneHandle, seconds: f64) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<SceneState>> = registry::find(scene)?;
        let mut state = registry::lock(&kept)?;
        let values = state.values;
        state.change(values, seconds)
    })
}

/// Tells what a scene is. `info` has its `struct_size` set.
///
/// # Safety
/// `info` points to as many bytes as it says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_scene_describe(
    scene: *const SceneHandle,
    info: *mut SceneInfo,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<SceneState>> = registry::find(scene)?;
        let state = registry::lock(&kept)?;
        let size = state.scene.image;
        let told = SceneInfo {
            struct_size: 0,
            width: size.width,
            height: size.height,
            sources: state.scene.source_count() as u64,
            time: state.time,
            period: state.read.period().unwrap_or(0.0),
            is_animated: state.read.is_animated().into(),
            warnings: u32::try_from(state.warnings.len()).unwrap_or(u32::MAX),
        };
        // SAFETY: the caller's promise.
        unsafe { border::write_struct(info, "info", told) }
    })
}

/// Gives what can be drawn and was hardly meant, such as angles in radians, a line each. `*text` is freed by
/// energywave_text_free.
///
/// # Safety
/// `text` points to a place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_scene_warnings(
    scene: *const SceneHandle,
    text: *mut *mut c_char,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<SceneState>> = registry::find(scene)?;
        // SAFETY: the caller's promise.
        let text = unsafe { border::out(text, "text") }?;
        let state = registry::lock(&kept)?;
        let lines = state.warnings.iter().map(|warning| format!("{warning}\n"));
        text.set(give_text(&lines.collect::<String>()));
        Ok(())
    })
}
