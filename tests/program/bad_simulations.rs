//! Every fault of waves of particles and of what they hit is told with its place.

use energywave::Scene;

use crate::bad_scenes::CAMERA;

/// What follows `[camera]` of three lines; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "[[wave]]\nspeed = 1\n",
        "4:1: wave[0].direction",
        "required, but missing",
    ),
    (
        "[[wave]]\ndirection = [0, 0, 0]\n",
        "5:13: wave[0].direction",
        "has no direction",
    ),
    (
        "[[wave]]\ndirection = [1, 0]\n",
        "5:13: wave[0].direction",
        "expected three numbers, found 2",
    ),
    (
        "[[wave]]\ndirection = 1\n",
        "5:13: wave[0].direction",
        "expected a list",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\norigin = [nan, 0, 0]\n",
        "6:10: wave[0].origin",
        "not a finite number",
    ),
    (
        "[[wave]]\ndirection = [1, inf, 0]\n",
        "5:13: wave[0].direction",
        "not a finite number",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nlifetime = 0\n",
        "6:12: wave[0].lifetime",
        "must be positive",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nreach = -1\n",
        "6:9: wave[0].reach",
        "must be positive",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nsize = 0.0\n",
        "6:8: wave[0].size",
        "must be positive",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nflight = 0\n",
        "6:10: wave[0].flight",
        "must be positive",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nrate = -20\n",
        "6:8: wave[0].rate",
        "must not be negative, found -20",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nrate = [1, 2]\n",
        "6:8: wave[0].rate",
        "expected a number",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nrate = \"20\"\n",
        "6:8: wave[0].rate",
        "expected a number; write 20",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nspeed = -2\n",
        "6:9: wave[0].speed",
        "must not be negative",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nlifetime_range = 41\n",
        "6:18: wave[0].lifetime_range",
        "41 is more than the 40",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nacceleration = { continuous = 0.25 }\n",
        "6:31: wave[0].acceleration.continuous_range",
        "0.5 is more than the 0.25 that it is around; give at most that",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nacceleration = { separate = -1 }\n",
        "6:29: wave[0].acceleration.separate",
        "must not be negative",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nsamples = 0\n",
        "6:11: wave[0].samples",
        "give from 1 to 1024",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nthreads = 0\n",
        "6:11: wave[0].threads",
        "give from 1 to 1024",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nroundness = 0\n",
        "6:13: wave[0].roundness",
        "lies above 0 and up to 1",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nroundness = 1.5\n",
        "6:13: wave[0].roundness",
        "lies above 0 and up to 1",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncontinuous = 1.5\n",
        "6:14: wave[0].continuous",
        "lies between 0 and 1; found 1.5",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncircular = -0.1\n",
        "6:12: wave[0].circular",
        "lies between 0 and 1; found -0.1",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncircular = 0.5\n",
        "4:1: wave[0].control",
        "there are none: add control = [{",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncircular = 0.5\ncontrol = [{ position = [1, 2, 3], probability = 0 }]\n",
        "7:11: wave[0].control",
        "the probabilities of all control points are 0",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncontrol = [{ position = [1, 2, 3], probability = 2 }]\n",
        "6:50: wave[0].control[0].probability",
        "lies between 0 and 1; found 2",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncontrol = [{ position = [1, 2, 3], range = [0, -1, 0] }]\n",
        "6:44: wave[0].control[0].range",
        "must not be negative",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\ncontrol = { position = [1, 2, 3] }\n",
        "6:11: wave[0].control",
        "control = [{ }]",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nmixture = [{ probability = 0.7 }, { probability = 0.7 }]\n",
        "6:11: wave[0].mixture",
        "add up to 1.4, more than 1",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nmixture = [{ samples = 3 }]\n",
        "6:12: wave[0].mixture[0].probability",
        "required",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nsigns = \"wrong\"\n",
        "6:9: wave[0].signs",
        "expected `corrected` or `printed`",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nresponse = \"bounce\"\n",
        "6:12: wave[0].response",
        "`replace` or `accelerate`",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nlifetme = 3\n",
        "6:1: wave[0].lifetme",
        "did you mean `lifetime`?",
    ),
    (
        "[wave]\ndirection = [1, 0, 0]\n",
        "4:1: wave",
        "write double brackets, [[wave]]",
    ),
    (
        "[collider]\nvisible = true\n",
        "4:1: collider",
        "write double brackets, [[collider]]",
    ),
    (
        "[[simulation]]\nseed = 1\n",
        "4:1: simulation",
        "write single brackets, [simulation]",
    ),
    (
        "[simulation]\nframe = 0\n",
        "5:9: simulation.frame",
        "must be positive",
    ),
    (
        "[simulation]\ntime = -1\n",
        "5:8: simulation.time",
        "counted from 0 to 1000000; found -1",
    ),
    (
        "[simulation]\nseed = -1\n",
        "5:8: simulation.seed",
        "a whole number from 0",
    ),
    (
        "[simulation]\ntime = 1e6\n[[wave]]\ndirection = [1, 0, 0]\nrate = 5000\n",
        "8:8: wave[0].rate",
        "at most 2^32: give a smaller rate",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nrate = { times = [0, 1], values = [20, -1] }\n",
        "6:8: wave[0].rate",
        "must not be negative, found -1",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\nrate = { times = [0, 1], values = [[20, 1], [3, 4]] }\n",
        "6:8: wave[0].rate",
        "the values of its track have another shape; expected a number",
    ),
    (
        "[[wave]]\ndirection = [1, 0, 0]\norigin = { times = [1, 0], values = [[1, 2, 3], [3, 4, 5]] }\n",
        "6:24: wave[0].origin.times[1]",
        "0 s is not later than the 1 s before it",
    ),
    (
        "[[collider]]\nvisible = true\n",
        "4:1: collider[0]",
        "it has no shape: write box = {",
    ),
    (
        "[[collider]]\nsphere = { radius = 1 }\nplane = { }\n",
        "4:1: collider[0]",
        "it has several shapes",
    ),
    (
        "[[collider]]\nmesh = \"ship.obj\"\n",
        "5:8: collider[0].mesh",
        "expected a table",
    ),
    (
        "[[collider]]\nmesh = { file = \"ship.obj\" }\n",
        "5:17: collider[0].mesh.file",
        "ship.obj: cannot read",
    ),
    (
        "[[collider]]\nmesh = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 3]] }\n",
        "5:68: collider[0].mesh.triangles",
        "triangle 0 names vertex 3",
    ),
    (
        "[[collider]]\nmesh = { vertices = [[0, 0, 0], [1, 0, 0], [0, nan, 0]], triangles = [[0, 1, 2]] }\n",
        "5:21: collider[0].mesh.vertices",
        "finite",
    ),
    (
        "[[collider]]\nmesh = { scale = 0, vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }\n",
        "5:18: collider[0].mesh.scale",
        "must be positive",
    ),
    (
        "[[collider]]\nmesh = { }\n",
        "5:8: collider[0].mesh.vertices",
        "there are no vertices",
    ),
    (
        "[[collider]]\nmesh = { albedo = [1, 1, 1], vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }\n",
        "5:19: collider[0].mesh.albedo",
        "the colour of a collider is its `color`",
    ),
    (
        "[[collider]]\ncolor = [2, 1, 1]\nmesh = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }\n",
        "5:9: collider[0].color",
        "the share of light that it throws back",
    ),
    (
        "[[collider]]\nmesh = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }\n[[wave]]\ndirection = [1, 0, 0]\n\
         response = \"accelerate\"\n",
        "8:12: wave[0].response",
        "close it, or write response",
    ),
    (
        "[[collider]]\nbox = { center = [0, 0, 0] }\n",
        "5:7: collider[0].box.half",
        "required, but missing",
    ),
    (
        "[[collider]]\nbox = { half = [1, 0, 1] }\n",
        "5:16: collider[0].box.half",
        "must be positive",
    ),
    (
        "[[collider]]\nbox = { half = [1, 1, 1], rotation = { axis = [0, 0, 0], angle = 3 } }\n",
        "5:47: collider[0].box.rotation.axis",
        "has no direction",
    ),
    (
        "[[collider]]\nsphere = { radius = -1 }\n",
        "5:21: collider[0].sphere.radius",
        "must be positive",
    ),
    (
        "[[collider]]\nsphere = { radius = 1, center = [0, nan, 0] }\n",
        "5:33: collider[0].sphere.center",
        "finite",
    ),
    (
        "[[collider]]\nplane = { normal = [0, 0, 0] }\n",
        "5:20: collider[0].plane.normal",
        "has no direction",
    ),
    (
        "[[collider]]\nball = { radius = 1 }\n",
        "5:1: collider[0].ball",
        "unknown field `ball`",
    ),
];

#[test]
fn every_fault_of_what_is_simulated_is_told_with_its_place() {
    let mut wrong = Vec::new();
    for (text, place, words) in BAD {
        let message = match Scene::from_toml(&format!("{CAMERA}{text}")) {
            Ok(_) => "it was read".to_owned(),
            Err(error) => error.to_string(),
        };
        if !message.contains(words) || !message.contains(&format!("{place}:")) {
            wrong.push(format!(
                "{text}expected {place}: {words}\nfound    {message}\n"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
