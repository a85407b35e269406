//! Tests that need a process of their own: its environment, its loader of OpenCL, its memory.

use std::any::type_name_of_val;
use std::process::Command;

/// Says in the environment which test the process is for.
const VARIABLE: &str = "ENERGYWAVE_TEST_APART";

/// An assertion of PoCL 3.1 itself, which one run in 50 with several devices of one CPU ends in, more with an empty
/// cache: kernels that two of them let go of at the same time. Such a run says nothing, and is made again.
const ABORT_OF_POCL: &str = "pocl_release_dlhandle_cache: Assertion";

/// Runs a test in a process of its own, with these environment variables. The test is the whole body of a test
/// function:
///
/// ```text
/// #[test]
/// fn the_layer_is_loaded() {
///     apart(&[("OPENCL_LAYERS", &path)], || { ... });
/// }
/// ```
#[track_caller]
pub fn apart<Test: FnOnce()>(variables: &[(&str, &str)], test: Test) {
    run(type_name_of_val(&test), variables, test);
}

/// Likewise, for a test function's closure of this name.
#[track_caller]
pub fn run(closure: &str, variables: &[(&str, &str)], test: impl FnOnce()) {
    // The function's name as the harness knows it, without those of the crate and of the closure.
    let name = closure.trim_end_matches("::{{closure}}");
    let name = name.split_once("::").unwrap().1;
    if std::env::var(VARIABLE).is_ok_and(|wanted| wanted == name) {
        test();
        return;
    }
    let once = || {
        Command::new(std::env::current_exe().unwrap())
            .args([name, "--exact", "--nocapture", "--test-threads=1"])
            .env(VARIABLE, name)
            .envs(variables.iter().copied())
            .output()
            .unwrap()
    };
    let mut output = once();
    for _ in 0..3 {
        if !String::from_utf8_lossy(&output.stderr).contains(ABORT_OF_POCL) {
            break;
        }
        output = once();
    }
    let said = String::from_utf8_lossy(&output.stdout);
    print!("{said}");
    eprint!("{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        output.status.success(),
        "{name} fails on its own: {}",
        output.status
    );
    assert!(
        said.contains("test result: ok. 1 passed"),
        "there is no test {name}"
    );
}
