//! The program: what was typed ([`args`]), then what is done, one file for each subcommand, then an exit code.

mod animate;
mod args;
mod bake;
mod bench;
mod bench_2006;
mod bench_2008;
mod bench_2013;
mod bench_crowd;
mod compare;
mod contacts;
mod devices;
mod environment;
mod error_map;
mod examples;
mod export;
mod figures;
mod help;
mod new;
mod overrides;
mod progress;
mod records;
mod render;
mod scene_help;
mod subcommands;
mod verify;
mod watch;

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use anstyle::AnsiColor;
use clap::Parser;
use energywave::scene::keys::json_schema;
use energywave::scene::{AnimatedScene, Method, MethodKeys, Scene};
use energywave::{Device, DeviceType, Devices, Error, ErrorKind, SceneError, shown, shown_lines};

use args::{Arguments, Command};

/// How a subcommand can fail.
enum Failure {
    /// In the library.
    Error(Error),
    /// Some rays are off by more than the limit.
    Verification(String),
    /// The reader of what was written has left: nothing is said, that program has its own reasons.
    Unread,
    /// Ctrl-C was pressed; what has been done says this.
    Interrupted(String),
    /// Standard output cannot be written.
    Stdout(io::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

type Outcome = Result<(), Failure>;

/// Runs the program; `warnings` are of what it found before.
pub fn run(warnings: &[String]) -> ExitCode {
    be_quiet_of_decoders();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return misused(&error),
    };
    IS_QUIET.store(arguments.quiet, Ordering::Relaxed);
    environment::check();
    warnings.iter().for_each(|warning| warn(warning));
    let outcome = match arguments.command {
        Command::Render(arguments) => render::run(arguments),
        Command::Animate(arguments) => animate::run(&arguments),
        Command::Watch(arguments) => watch::run(arguments),
        Command::Bake(arguments) => bake::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Contacts(arguments) => contacts::run(&arguments),
        Command::Figures(arguments) => figures::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Schema => print(&format!("{}\n", json_schema())),
        Command::Completions(arguments) => help::completions(&arguments),
        Command::Man(arguments) => help::manual(&arguments),
        Command::Help(arguments) => help::run(&arguments),
    };
    let Err(failure) = outcome else {
        return ExitCode::SUCCESS;
    };
    let (message, code) = match failure {
        Failure::Error(error) => (format!("{error}{}", hint(&error)), exit_code(&error)),
        Failure::Verification(message) => (message, 6),
        Failure::Interrupted(message) => (message, 130),
        Failure::Unread => return ExitCode::from(7),
        // The reader of a pipe may leave early; that is not our failure.
        Failure::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe => {
            return ExitCode::SUCCESS;
        }
        Failure::Stdout(error) => (format!("standard output: cannot write: {error}"), 7),
    };
    tell("error", AnsiColor::Red, &message);
    ExitCode::from(code)
}

/// Keeps the panics of decoders of damaged files, which are caught and end in an error, from standard error.
fn be_quiet_of_decoders() {
    let others = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(energywave::image::DECODER_THREAD) {
            others(panic);
        }
    }));
}

/// Says what was typed wrong, or the help that was asked for; what was typed is repeated neither raw nor at length.
fn misused(error: &clap::Error) -> ExitCode {
    let plain = error.render().to_string();
    let is_tame = |line: &str| shown_lines(line) == line && line.chars().count() <= MOST_COLUMNS;
    if !error.use_stderr() || plain.lines().all(is_tame) {
        error.exit();
    }
    for line in plain.lines() {
        let length = line.chars().count();
        let end: String = line.chars().skip(length.max(HALF) - HALF).collect();
        match length > MOST_COLUMNS {
            true => {
                let begin: String = line.chars().take(HALF).collect();
                write_line("", &format!("{begin}…{end}"));
            }
            false => write_line("", line),
        }
    }
    ExitCode::from(2)
}

/// Longest line of a usage error that is printed whole.
const MOST_COLUMNS: usize = 200;
const HALF: usize = MOST_COLUMNS / 2;

/// Returns the exit code of an error, one of those that `--help` lists.
fn exit_code(error: &Error) -> u8 {
    match error.kind() {
        ErrorKind::Unsupported | ErrorKind::OutputFormat => 2,
        ErrorKind::Scene | ErrorKind::Input => 3,
        ErrorKind::NoSuchDevice => 4,
        ErrorKind::Output => 7,
        ErrorKind::Interrupted => 130,
        _ => 5, // the device failed, or there is too little memory
    }
}

/// Says how the command line does what the library advises.
fn hint(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::SelfTest => " with --device, or insist on this one with --no-self-test",
        ErrorKind::Device => " (--device chooses another device)",
        _ => "",
    }
}

/// Chooses the devices of `--device`, else of `ENERGYWAVE_DEVICE`, else the best, and says on standard error which they
/// are. No driver is loaded where the built-in reference is asked for.
fn choose_devices(flag: Option<&str>) -> Result<Vec<Device>, Error> {
    let variable = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_default();
    let choice = flag.or(Some(variable.as_str()).filter(|word| !word.is_empty()));
    if choice.is_some_and(|word| word.trim().eq_ignore_ascii_case("reference")) {
        note("device: reference (built in, float64)");
        return Ok(vec![Device::reference()]);
    }
    let devices = Devices::discover();
    let chosen = match choice {
        Some(word) => devices.select_all(word)?,
        None => vec![devices.best_or_reference()],
    };
    let is_reference = |device: &Device| device.device_type == DeviceType::Reference;
    if choice.is_none() && chosen.iter().any(is_reference) {
        let problem = match devices.problem() {
            Some(problem) => problem.to_owned(),
            None => devices.absent().join("; "),
        };
        warn(&format!(
            "{problem}; the built-in reference draws, hundreds of times slower"
        ));
    }
    for device in &chosen {
        note(&format!("device: {device}"));
    }
    Ok(chosen)
}

/// Returns the names of all devices.
fn names(devices: &[Device]) -> String {
    let names: Vec<&str> = devices.iter().map(|device| device.name.as_str()).collect();
    names.join(" + ")
}

/// Returns a method in words, with what it is asked for.
fn method_name(method: Method) -> String {
    match method {
        Method::Exact { tolerance, .. } => format!("exact, tolerance {tolerance:e}"),
        Method::Simpson { divisions } => format!("simpson, {divisions} divisions"),
        Method::Jittered { divisions, .. } => format!("jittered, {divisions} divisions"),
        _ => String::new(),
    }
}

/// Reads a scene from a file, or from standard input if it is called `-`, and says what was hardly meant in it.
fn read_scene(
    path: &Path,
    adjust: impl FnMut(&mut Scene, &MethodKeys) -> Result<(), Error>,
) -> Result<Scene, Error> {
    let (scene, warnings) = open_scene(path)?.into_frame(0.0, adjust)?;
    warn_all(&warnings);
    Ok(scene)
}

/// Opens a scene that may move.
fn open_scene(path: &Path) -> Result<AnimatedScene, Error> {
    match path == Path::new("-") {
        true => AnimatedScene::from_reader(io::stdin().lock(), "standard input"),
        false => AnimatedScene::from_file(path),
    }
}

fn warn_all(warnings: &[SceneError]) {
    for warning in warnings {
        warn(&warning.to_string());
    }
}

/// Says on standard error what the scene's depths come to, and what is likely wrong with them.
fn tell_depths(scene: &Scene) {
    let Some(report) = scene.depth_report() else {
        return;
    };
    let file = scene.depth.as_ref().and_then(|depth| depth.file());
    let name = file.and_then(|file| file.file_name()).unwrap_or_default();
    let name = shown(&name.to_string_lossy());
    note(&format!("depth: {name}: {report}"));
    for warning in &report.warnings {
        warn(&format!("{name}: {warning}"));
    }
}

/// Whether only warnings and errors are wanted.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Writes a warning to standard error, also where quiet is asked for: the work goes on, but not as was meant.
fn warn(message: &str) {
    tell("warning", AnsiColor::Yellow, message);
}

/// Writes what is good to know to standard error, unless quiet is asked for.
fn note(message: &str) {
    if !is_quiet() {
        write_line("", message);
    }
}

/// Writes a message to standard error, with a word before it that has a colour where a terminal shows colours.
fn tell(word: &str, color: AnsiColor, message: &str) {
    let style = color.on_default().bold();
    write_line(&format!("{style}{word}:{style:#} "), message);
}

/// Writes a message, mostly one line. Here at the latest nothing is left in it that a terminal obeys.
fn write_line(head: &str, message: &str) {
    progress::beside(|| {
        // Nobody is left to tell if standard error is closed.
        let _ = writeln!(anstream::stderr(), "{head}{}", shown_lines(message));
    });
}

/// Writes data to standard output.
fn print(data: &str) -> Outcome {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(data.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(Failure::Stdout)
}

/// Writes JSON to standard output.
fn print_json(data: &impl serde::Serialize) -> Outcome {
    match serde_json::to_string_pretty(data) {
        Ok(text) => print(&format!("{text}\n")),
        Err(error) => Err(Failure::Stdout(error.into())),
    }
}
