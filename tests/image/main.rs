//! Whole images, and what makes them, against float64.
#![allow(clippy::unwrap_used, clippy::panic)] // tests fail by panicking

#[path = "../common/mod.rs"]
mod common;

mod along;
mod along_cases;
mod arcs; // draws displaced cores as the reference does
mod beams;
mod built; // compares beams with the lines and points that they are made of
mod cameras; // holds matrices of engines to where they project points
mod cast_cases; // sources that cast light, by definition
mod cast_laws; // what that obeys: no jumps, sums of parts, capsules from afar
mod cast_light; // holds the light that waves cast on surfaces to sums of random places
mod cast_shadows; // holds what meshes leave of it to the reference
mod clip_depths; // holds depths of clip space to the surfaces that a rasteriser met
mod convolution;
mod convolved_paths; // holds light that adds up over a core to its definition
mod crowd_depths;
mod crowd_spread;
mod crowd_truth; // crowds of every shape and number are what float64 sums up
mod crowds; // holds crowds of points to the sum over all of them
mod defaults; // looks at a scene that names nothing
mod depth; // compares occluded images with those of rays that are cut by hand
mod depth_edges; // compares edges of what hides the light with the means of many rays
mod exact; // holds the method `exact` to every tolerance
mod fading; // fades light by every power, and absorbs it
mod fading_forms; // holds the reference to closed forms of points and lines that fade
mod figures; // draws every scene by every method in the form of the device
mod flicker; // pans over presets by tenths of a pixel, and reads the animations
mod footprint; // compares pixels with the means of many rays
mod hard_scenes; // takes the method `exact` through cores, along them, and to extreme numbers
mod images; // bounds the worst pixel of the Simpson rule
mod jittered; // holds stratified samples to their definition, and shows what they gain
mod laws; // checks what every image obeys: linearity, order, mirror, motion, scale
mod layers; // holds several lights of one core to as many sources
mod meshes; // compares meshes with float64, and with what hides and is hidden
mod metaballs; // holds surfaces to float64 by another method
mod particle_rays; // gives single rays the light of particles that their pixels show
mod particle_views; // sees particles through every camera, blurred, and with a bloom
mod particles; // holds balls and streaks of light to float64
mod parts; // draws rows, rays and changed scenes as the whole image has them
mod path_core; // what a path is by definition
mod paths; // holds paths to their definition
mod points; // points of light: as many spheres, from every kind of file
mod presets; // draws every preset, and looks at its whites and blacks
mod rays; // compares single rays with integrals that are known to nine digits
mod rms; // holds roots of integrals of squares to their definition
mod search; // draws what examples/hard_scenes has found
mod segment; // holds segments to their definition
mod shape_forms; // takes closed forms of shapes along every part of a ray
mod shapes; // holds how fields fall off to their definition
mod shutter; // blurs motion
mod surfaces; // draws surfaces among light
mod tiles; // holds interpolation by tiles to the tolerance, and counts what it costs
mod tone_maps; // holds tone maps to their published constants
mod volume_rest;
mod volume_steps; // rays through cells where light changes little
mod volumes;
