//! A window that shows a scene: plays it, goes through its time, turns its camera, and draws it again when its file
//! changes.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use anstyle::AnsiColor;
use energywave::image::{Alpha, Display};
use energywave::scene::AnimatedScene;
use energywave::{Error, shown};
use minifb::{InputCallback, Key, MouseButton, MouseMode, ScaleMode, Window, WindowOptions};

use super::WatchArguments;
use super::orbit::Orbit;
use super::picture::{Picture, Pictures, is_of_file};
use crate::cli::progress::{catch_interrupts, was_interrupted};
use crate::cli::{Failure, Outcome, tell};

/// Of a window without a picture, pixels.
const EMPTY: (usize, usize) = (640, 360);

/// Of the frame that says that something is wrong, pixels, and its colour.
const FRAME: usize = 4;
const RED: u32 = 0x00e0_2020;

/// While a picture is drawn, the window hears so often.
const HEAR: Duration = Duration::from_millis(50);

/// A file that cannot be read may be half written: for so long it is tried again.
const PATIENCE: Duration = Duration::from_millis(200);

/// Arrow keys go so many frames a second without --fps.
const RATE: f64 = 24.0;

/// Dragged across the window, the camera turns by so much, radians.
const TURN: f64 = std::f64::consts::PI;

/// Hears every key that is pressed, also while a picture is drawn.
struct Keys(Sender<Key>);

impl InputCallback for Keys {
    fn add_char(&mut self, _: u32) {}

    fn set_key_state(&mut self, key: Key, is_down: bool) {
        if is_down {
            let _ = self.0.send(key); // the window may be about to close
        }
    }
}

/// What is shown.
struct Shown {
    pixels: Vec<u32>,
    size: (usize, usize),
    /// What is wrong with the file.
    fault: Option<String>,
    /// What is wrong with the scene at its time.
    fault_now: Option<String>,
    title: String,
}

/// What the viewer has chosen.
struct View {
    time: f64,
    is_playing: bool,
    /// When `time` was now, while it plays.
    clock: Instant,
    orbit: Orbit,
    /// Where the mouse was that drags.
    dragged: Option<(f32, f32)>,
    keys: Receiver<Key>,
    is_over: bool,
}

pub fn run(arguments: WatchArguments) -> Outcome {
    let options = WindowOptions {
        resize: true,
        scale_mode: ScaleMode::AspectRatioStretch,
        ..WindowOptions::default()
    };
    let size = arguments.overrides.size;
    let size = match (size, AnimatedScene::from_file(&arguments.scene)) {
        (Some(size), _) => (size.width as usize, size.height as usize),
        (None, Ok(scene)) => scene.at(0.0).map_or(EMPTY, |scene| {
            (scene.image.width as usize, scene.image.height as usize)
        }),
        (None, Err(_)) => EMPTY,
    };
    let mut window = Window::new("energywave", size.0, size.1, options).map_err(|error| {
        let message = format!("watch: no window ({error}); name an image to write: -o FILE");
        Failure::from(Error::Unsupported(message))
    })?;
    window.set_target_fps(60);
    let (sender, keys) = channel();
    window.set_input_callback(Box::new(Keys(sender)));
    catch_interrupts();
    let mut view = View {
        time: arguments.time.unwrap_or(0.0),
        is_playing: true,
        clock: Instant::now(),
        orbit: Orbit::default(),
        dragged: None,
        keys,
        is_over: false,
    };
    let mut shown = Shown {
        pixels: vec![0; size.0 * size.1],
        size,
        fault: None,
        fault_now: None,
        title: String::new(),
    };
    let mut pictures = Pictures::open(arguments)?;
    // When the file was changed that is to be read.
    let mut changed = Some(Instant::now());
    let mut is_stale = true;
    while goes_on(&window) && !view.is_over {
        if pictures.changes.are_there() {
            pictures.changes.take();
            changed = Some(Instant::now());
        }
        if let Some(since) = changed {
            match pictures.read() {
                Ok(()) => (changed, is_stale, shown.fault) = (None, true, None),
                Err(_) if since.elapsed() < PATIENCE => {}
                Err(error) => {
                    changed = None;
                    shown.fault = fault(error, &shown.fault)?;
                }
            }
        }
        is_stale |= view.hear(&window, &pictures);
        if is_stale && changed.is_none() {
            is_stale = false;
            // The time is told at once, however long its picture takes.
            shown.entitle(&mut window, &view, &pictures);
            match draw(&mut pictures, &view, &mut window, &shown) {
                Ok(picture) => shown.take(&picture),
                Err(Error::Interrupted) => {} // by a change, or the end
                Err(error) => shown.fault_now = fault(error, &shown.fault_now)?,
            }
        }
        shown.entitle(&mut window, &view, &pictures);
        update(&mut window, &shown)?;
    }
    Ok(())
}

fn goes_on(window: &Window) -> bool {
    window.is_open() && !window.is_key_down(Key::Escape) && !was_interrupted()
}

fn update(window: &mut Window, shown: &Shown) -> Result<(), Error> {
    window
        .update_with_buffer(&shown.framed(), shown.size.0, shown.size.1)
        .map_err(|error| Error::Unsupported(format!("watch: the window cannot be drawn: {error}")))
}

/// Draws what the viewer has chosen, and lets the window live meanwhile.
fn draw(
    pictures: &mut Pictures,
    view: &View,
    window: &mut Window,
    shown: &Shown,
) -> Result<Picture, Error> {
    let mut heard = Instant::now();
    let progress = &mut |_: f32| {
        if heard.elapsed() > HEAR {
            heard = Instant::now();
            let _ = update(window, shown); // the next one tells
        }
        match goes_on(window) {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    };
    pictures.draw(view.time, None, &|scene| view.orbit.turn(scene), progress)
}

impl View {
    /// Hears keys and the mouse; returns whether another picture is to be drawn.
    fn hear(&mut self, window: &Window, pictures: &Pictures) -> bool {
        let before = (self.time, self.orbit);
        let span = pictures.moving().and_then(AnimatedScene::span);
        let rate = pictures.arguments.fps.unwrap_or(RATE);
        while let Ok(key) = self.keys.try_recv() {
            match key {
                Key::Escape => self.is_over = true,
                Key::Space => (self.is_playing, self.clock) = (!self.is_playing, Instant::now()),
                Key::Home => self.orbit = Orbit::default(),
                Key::Left | Key::Right => {
                    let step = if key == Key::Left { -1.0 } else { 1.0 };
                    self.is_playing = false;
                    self.time = ((self.time * rate).round() + step) / rate;
                }
                _ => {}
            }
        }
        let (_, wheel) = window.get_scroll_wheel().unwrap_or_default();
        self.orbit.distance =
            (self.orbit.distance * f64::from(-wheel / 10.0).exp()).clamp(0.01, 100.0);
        self.drag(window, span.map_or(0.0, |span| span.seconds));
        let is_animated = pictures.moving().is_some_and(AnimatedScene::is_animated);
        if self.is_playing && is_animated {
            self.time += self.clock.elapsed().as_secs_f64();
            self.clock = Instant::now();
        }
        if let Some(span) = span.filter(|span| span.seconds > 0.0) {
            self.time = self.time.rem_euclid(span.seconds);
        }
        before != (self.time, self.orbit)
    }

    /// Turns the camera with the left button, and goes through the time with the right one.
    fn drag(&mut self, window: &Window, seconds: f64) {
        let turns = window.get_mouse_down(MouseButton::Left);
        let scrubs = window.get_mouse_down(MouseButton::Right);
        let mouse = window.get_mouse_pos(MouseMode::Pass);
        let (Some((x, y)), true) = (mouse, turns || scrubs) else {
            self.dragged = None;
            return;
        };
        let (from_x, from_y) = self.dragged.replace((x, y)).unwrap_or((x, y));
        let (width, height) = window.get_size();
        let across = f64::from(x - from_x) / width.max(1) as f64;
        let down = f64::from(y - from_y) / height.max(1) as f64;
        if turns {
            self.orbit.around -= TURN * across;
            self.orbit.over += TURN * down;
        } else if across != 0.0 {
            self.is_playing = false;
            self.time += seconds * across;
        }
    }
}

/// Says what is wrong with a file, unless that was said last; what cannot be righted ends the program.
fn fault(error: Error, last: &Option<String>) -> Result<Option<String>, Error> {
    if !is_of_file(&error) {
        return Err(error);
    }
    let message = error.to_string();
    if last.as_ref() != Some(&message) {
        tell("error", AnsiColor::Red, &message);
    }
    Ok(Some(message))
}

impl Shown {
    /// Shows a picture.
    fn take(&mut self, picture: &Picture) {
        let display = Display {
            alpha: Alpha::default(),
            bits: None,
            ..picture.scene.display.clone()
        };
        let picture = picture.light.tone_map(&display);
        let color = |pixel: &[u8]| u32::from_be_bytes([0, pixel[0], pixel[1], pixel[2]]);
        let pixels = picture.as_slice().chunks_exact(picture.channels());
        self.pixels.clear();
        self.pixels.extend(pixels.map(color));
        self.size = (
            picture.size().width as usize,
            picture.size().height as usize,
        );
        self.fault_now = None;
    }

    /// Returns what is wrong.
    fn what_is_wrong(&self) -> Option<&String> {
        self.fault.as_ref().or(self.fault_now.as_ref())
    }

    /// Returns the pixels, in a red frame if something is wrong.
    fn framed(&self) -> Cow<'_, [u32]> {
        if self.what_is_wrong().is_none() {
            return Cow::Borrowed(&self.pixels);
        }
        let mut pixels = self.pixels.clone();
        let (width, height) = self.size;
        let is_edge = |at: usize, length: usize| at < FRAME || at + FRAME >= length;
        for (number, pixel) in pixels.iter_mut().enumerate() {
            if is_edge(number % width, width) || is_edge(number / width, height) {
                *pixel = RED;
            }
        }
        Cow::Owned(pixels)
    }

    /// Names the window by what it shows, if that is another than before.
    fn entitle(&mut self, window: &mut Window, view: &View, pictures: &Pictures) {
        let file = pictures.arguments.scene.file_name().unwrap_or_default();
        let name = shown(&file.to_string_lossy());
        let moves = pictures.moving().is_some_and(AnimatedScene::is_animated);
        let title = match self.what_is_wrong() {
            Some(fault) => format!("error: {}", shown(fault)),
            None if moves => {
                let stands = if view.is_playing { "" } else { ", stopped" };
                format!("{name} - {:.2} s{stands}", view.time)
            }
            None => name,
        };
        if title != self.title {
            window.set_title(&title);
            self.title = title;
        }
    }
}
