//! What handles stand for. A handle is an odd number that is given once, so that it is neither NULL nor the address of
//! anything that C allocates, and one that was freed is known to be.

use std::collections::BTreeMap;
use std::ptr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use energywave::Renderer;

use crate::scene::SceneState;
use crate::status::{Failure, Outcome, Status, bad_argument};

/// What a handle stands for.
#[derive(Clone)]
pub enum Item {
    Scene(Arc<Mutex<SceneState>>),
    Renderer(Arc<Mutex<Renderer>>),
}

impl Item {
    fn name(&self) -> &'static str {
        match self {
            Self::Scene(_) => "scene",
            Self::Renderer(_) => "renderer",
        }
    }
}

struct Registry {
    items: BTreeMap<usize, Item>,
    /// The number that was given last.
    last: usize,
}

static REGISTRY: Mutex<Registry> = Mutex::new(Registry {
    items: BTreeMap::new(),
    last: 1,
});

/// Nothing under this lock can panic half-way.
fn registry() -> MutexGuard<'static, Registry> {
    REGISTRY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a handle may stand for.
pub trait Kind: Sized {
    const NAME: &'static str;
    fn wrap(kept: Arc<Mutex<Self>>) -> Item;
    fn unwrap(item: &Item) -> Option<&Arc<Mutex<Self>>>;
}

impl Kind for SceneState {
    const NAME: &'static str = "scene";

    fn wrap(kept: Arc<Mutex<Self>>) -> Item {
        Item::Scene(kept)
    }

    fn unwrap(item: &Item) -> Option<&Arc<Mutex<Self>>> {
        match item {
            Item::Scene(kept) => Some(kept),
            Item::Renderer(_) => None,
        }
    }
}

impl Kind for Renderer {
    const NAME: &'static str = "renderer";

    fn wrap(kept: Arc<Mutex<Self>>) -> Item {
        Item::Renderer(kept)
    }

    fn unwrap(item: &Item) -> Option<&Arc<Mutex<Self>>> {
        match item {
            Item::Renderer(kept) => Some(kept),
            Item::Scene(_) => None,
        }
    }
}

/// Keeps something, and returns its handle. `H` is what C calls it.
pub fn keep<T: Kind, H>(kept: T) -> *mut H {
    let item = T::wrap(Arc::new(Mutex::new(kept)));
    let mut registry = registry();
    registry.last += 2;
    let number = registry.last;
    registry.items.insert(number, item);
    ptr::without_provenance_mut(number)
}

/// Returns what a handle stands for; it lives as long as that is held, whoever frees the handle.
pub fn find<T: Kind, H>(handle: *const H) -> Outcome<Arc<Mutex<T>>> {
    if handle.is_null() {
        return Err(bad_argument(
            T::NAME,
            "NULL; it must be a handle that this library gave",
        ));
    }
    let registry = registry();
    let Some(item) = registry.items.get(&handle.addr()) else {
        let reason =
            "it was freed, or this library never gave it; keep a handle until its last use";
        return Err(bad_handle(T::NAME, reason));
    };
    T::unwrap(item)
        .cloned()
        .ok_or_else(|| wrong_kind::<T>(item))
}

/// Frees a handle; NULL is none. What it stands for ends when the last call that uses it does.
pub fn free<T: Kind, H>(handle: *mut H) -> Outcome {
    if handle.is_null() {
        return Ok(());
    }
    drop(find::<T, H>(handle)?);
    let item = registry().items.remove(&handle.addr());
    // The register is open again while this ends: a renderer waits for its device.
    drop(item);
    Ok(())
}

/// Takes what a handle stands for, for a call alone: others wait.
///
/// # Errors
/// A panic in an earlier call has left it in an unknown state.
pub fn lock<T: Kind>(kept: &Mutex<T>) -> Outcome<MutexGuard<'_, T>> {
    kept.lock().map_err(|_| {
        let name = T::NAME;
        let message =
            format!("{name}: an earlier fault of the library broke it; free it, and make another");
        Failure::Call(Status::Internal, message)
    })
}

fn wrong_kind<T: Kind>(item: &Item) -> Failure {
    let reason = format!("it is a {}; give the handle of a {}", item.name(), T::NAME);
    bad_handle(T::NAME, &reason)
}

fn bad_handle(name: &str, reason: &str) -> Failure {
    Failure::Call(Status::BadHandle, format!("{name}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneHandle;
    use energywave::Device;

    #[test]
    fn what_is_freed_ends_and_its_handle_is_known_to_be_none() {
        let renderer = || Renderer::new(&Device::reference()).unwrap();
        let handle: *mut crate::renderer::RendererHandle = keep(renderer());
        let kept = find::<Renderer, _>(handle).unwrap();
        let weak = Arc::downgrade(&kept);
        assert!(find::<SceneState, _>(handle.cast::<SceneHandle>()).is_err());
        free::<Renderer, _>(handle).unwrap();
        assert!(weak.upgrade().is_some(), "a call that uses it holds it");
        drop(kept);
        assert!(weak.upgrade().is_none(), "and nothing else does");
        assert!(free::<Renderer, _>(handle).is_err());
        let next: *mut crate::renderer::RendererHandle = keep(renderer());
        assert_ne!(next, handle);
        free::<Renderer, _>(next).unwrap();
    }

    #[test]
    fn what_a_panic_broke_is_not_used_again() {
        let kept = Arc::new(Mutex::new(Renderer::new(&Device::reference()).unwrap()));
        let other = Arc::clone(&kept);
        let status = crate::status::guarded(|| {
            let _held = lock(&other)?;
            panic!("planted")
        });
        assert_eq!(status, Status::Internal);
        assert!(lock(&kept).is_err());
    }
}
