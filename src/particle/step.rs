//! One step of a simulation, which is one frame: particles are emitted and move; those that enter a solid on their way
//! hit it where they do (a sweep: no speed passes through), then forces give them their new velocity.
//!
//! Every step depends on the state before alone, and forces on where all particles would be at its end if there were no
//! solids, which no force of the step changes any more: no order matters.

use glam::DVec3;

use super::Contact;
use super::force::Touch;
use super::laws::Laws;
use super::neighbours::Neighbours;
use super::solid::Entry;
use super::state::{Body, Impact, Name, Phase, State};

/// What of a step is kept for the next, so that it takes no new memory.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    touches: Vec<Touch>,
    neighbours: Neighbours,
    /// Which part of the frame is left to particles that are emitted in it.
    rests: Vec<f64>,
}

/// Where a motion first enters a solid.
struct Meeting {
    solid: usize,
    entry: Entry,
}

impl Laws {
    /// Goes on by a frame, and shows every contact.
    pub(super) fn step(
        &self,
        state: &mut State,
        scratch: &mut Scratch,
        see: &mut impl FnMut(Contact),
    ) {
        let old = state.bodies.len();
        self.emit(state, &mut scratch.rests);
        self.go(state, old, scratch);
        if !scratch.touches.is_empty() {
            let reach = self.reach();
            let all = state.alive().map(|(body, _)| body.position);
            let asking = scratch.touches.iter();
            let asking = asking.map(|touch| state.bodies[touch.index].position);
            scratch.neighbours.gather(asking, all, reach);
            for touch in &scratch.touches {
                self.respond(state, touch, &scratch.neighbours, see);
            }
        }
        state.drop_over();
        state.frame += 1;
    }

    fn emit(&self, state: &mut State, rests: &mut Vec<f64>) {
        rests.clear();
        let frame = state.frame;
        for (index, (law, emitted)) in self.waves.iter().zip(&mut state.emitted).enumerate() {
            let wave = &law.wave;
            emitted.rest += wave.rate.at(self.seconds(frame)).max(0.0);
            let count = emitted.rest.floor();
            emitted.rest -= count;
            let velocity = wave.speed * self.direction(wave, frame);
            for _ in 0..count as u64 {
                let name = Name {
                    id: emitted.count as u32,
                    wave: index as u32,
                };
                let (position, when) = self.emission(name, frame);
                state.bodies.push(Body {
                    position,
                    velocity,
                    until: f64::from(frame) + when + wave.flight,
                    name,
                    hit: 0,
                    phase: Phase::Flying,
                    is_continuous: false,
                    mixture: 0,
                });
                state.impacts.push(Impact::NONE);
                rests.push(1.0 - when);
                emitted.count += 1;
            }
        }
    }

    /// Moves all particles, ends those whose time is over, and lists those that hit something, or are within it.
    fn go(&self, state: &mut State, old: usize, scratch: &mut Scratch) {
        let Scratch { touches, rests, .. } = scratch;
        touches.clear();
        let now = f64::from(state.frame);
        for (index, body) in state.bodies.iter_mut().enumerate() {
            let rest = match index.checked_sub(old) {
                Some(new) => rests[new],
                None => 1.0,
            };
            let motion = rest * body.velocity;
            let meeting = match body.phase {
                Phase::Flying | Phase::Circular => self.meeting(body, motion),
                Phase::Irregular | Phase::Within => None,
                Phase::Over => continue,
            };
            if meeting.is_none() && body.until < now + 1.0 {
                body.phase = Phase::Over;
                state.over += 1;
                continue;
            }
            let begin = body.position;
            body.position += motion;
            if let Some(Meeting { solid, entry }) = meeting {
                touches.push(Touch {
                    index,
                    solid,
                    point: begin + entry.share * motion,
                    place: begin + self.share_before(&entry, motion) * motion,
                    normal: entry.normal,
                    end: body.position,
                    time: now + (1.0 - rest) + entry.share * rest,
                    is_new: true,
                });
            } else if body.phase == Phase::Within {
                self.stay_or_leave(body, &state.impacts[index], index, touches);
            }
        }
    }

    /// Returns at which share of its motion a particle is still before what it hits, where there are meshes: the way to
    /// there is free, whatever rounding makes of the point where it hits.
    fn share_before(&self, entry: &Entry, motion: DVec3) -> f64 {
        let inward = -motion.dot(entry.normal);
        match self.clearance > 0.0 && inward > 0.0 {
            true => (entry.share - self.clearance / inward).max(0.0),
            false => entry.share,
        }
    }

    /// Lists a particle that is still within what it hit; one that has left flies on.
    fn stay_or_leave(
        &self,
        body: &mut Body,
        impact: &Impact,
        index: usize,
        touches: &mut Vec<Touch>,
    ) {
        let solid = (body.hit as usize).saturating_sub(1);
        let is_within = |solid: &super::solid::Solid| solid.distance(body.position) < 0.0;
        if self.solids.get(solid).is_some_and(is_within) {
            touches.push(Touch {
                index,
                solid,
                point: impact.point,
                place: body.position,
                normal: impact.normal,
                end: body.position,
                time: 0.0,
                is_new: false,
            });
        } else {
            (body.phase, body.hit) = (Phase::Circular, 0);
        }
    }

    /// Returns where a motion first enters a solid; of two at once the first of the scene.
    fn meeting(&self, body: &Body, motion: DVec3) -> Option<Meeting> {
        let mut first: Option<Meeting> = None;
        for (index, solid) in self.solids.iter().enumerate() {
            if body.hit as usize == index + 1 && solid.is_convex() {
                continue;
            }
            let found = match self.sweeps {
                true => solid.entry(body.position, motion, 1.0),
                false => stepped(solid, body.position + motion),
            };
            if let Some(entry) = found
                && first.as_ref().is_none_or(|it| entry.share < it.entry.share)
            {
                first = Some(Meeting {
                    solid: index,
                    entry,
                });
            }
        }
        first
    }
}

/// Looks only where a step ends, as the thesis does: what a test compares the sweep with.
fn stepped(solid: &super::solid::Solid, end: DVec3) -> Option<Entry> {
    (solid.distance(end) < 0.0).then(|| Entry {
        share: 1.0,
        normal: solid.normal(end),
    })
}
