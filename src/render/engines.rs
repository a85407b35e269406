//! The engines of light of a device, which draw into one film in turn: the wave, then volumes, then
//! particles.

use std::ops::{ControlFlow, Range};

use crate::cost::FrameCost;
use crate::crowd::{Crowd, CrowdPlan};
use crate::error::Result;
use crate::glow::{Glow, GlowPlan};
use crate::opencl::{Compute, Film, FilmFormat, RendererOptions};
use crate::scene::{Profile, Ray, Scene};
use crate::texture::{TexturePlan, Textures, Turn};
use crate::wave::{DeviceDepths, Plan, Wave};

#[derive(Debug)]
pub(super) struct Engines {
    pub wave: Wave,
    glow: Glow,
    textures: Textures,
    /// Of each profile that there are crowds of.
    crowds: [Crowd; 2],
    /// Which of them the last plan was for.
    has_wave: bool,
    has_glow: bool,
    has_textures: bool,
    has_crowds: [bool; 2],
}

/// What each of them is to draw.
#[derive(Debug)]
pub(super) struct FramePlan {
    wave: Option<Plan>,
    glow: Option<GlowPlan>,
    textures: Option<TexturePlan>,
    crowds: [Option<CrowdPlan>; 2],
}

impl FramePlan {
    /// Returns the number that the pixels of a band are a multiple of, if it is no picture or all of one.
    pub(super) fn grain(&self) -> u32 {
        self.wave.as_ref().map_or(1, Plan::grain)
    }
}

impl Engines {
    pub(super) fn new(compute: &Compute, options: &RendererOptions) -> Result<Self> {
        Ok(Self {
            wave: Wave::new(compute, options)?,
            glow: Glow::new(options),
            textures: Textures::new(options),
            crowds: [Profile::Inverse, Profile::InverseSquare]
                .map(|profile| Crowd::new(options, profile)),
            has_wave: true,
            has_glow: false,
            has_textures: false,
            has_crowds: [false; 2],
        })
    }

    /// Returns how many kernels were built.
    pub(super) fn kernel_count(&self) -> usize {
        let crowds: usize = self.crowds.iter().map(Crowd::kernel_count).sum();
        let others = self.glow.kernel_count() + self.textures.kernel_count();
        self.wave.kernel_count() + others + crowds
    }

    /// Returns what the last frame cost.
    pub(super) fn cost(&self) -> FrameCost {
        let parts = [
            self.has_wave.then(|| self.wave.cost()),
            self.has_textures.then(|| self.textures.cost()),
            self.has_glow.then(|| self.glow.cost()),
            self.has_crowds[0].then(|| self.crowds[0].cost()),
            self.has_crowds[1].then(|| self.crowds[1].cost()),
        ];
        let drawn = parts.into_iter().flatten();
        let mut cost = drawn.reduce(FrameCost::then).unwrap_or_default();
        cost.crowds.bytes = self.crowds.iter().map(Crowd::bytes).sum();
        cost
    }

    /// Plans a frame of a valid scene, behind depths that the device has, if there are any: the scene then has none.
    pub(super) fn plan(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<DeviceDepths>,
        format: FilmFormat,
    ) -> Result<FramePlan> {
        let depths = there.map(|depths| (depths.memory, depths.along));
        let glow = self.glow.plan(compute, scene, depths, format)?;
        self.has_glow = glow.is_some();
        let textures = self.textures.plan(compute, scene, depths, format)?;
        self.has_textures = textures.is_some();
        let mut crowds = [None, None];
        for (plan, crowd) in crowds.iter_mut().zip(&mut self.crowds) {
            *plan = crowd.plan(compute, scene, depths, format)?;
        }
        self.has_crowds = crowds.each_ref().map(Option::is_some);
        // Where nothing is drawn, somebody draws black.
        let has_others = self.has_glow || self.has_textures || self.has_crowds.contains(&true);
        self.has_wave = scene.source_count() > 0 || !has_others;
        let wave = match self.has_wave {
            true => Some(self.wave.plan_behind(compute, scene, there, format)?),
            false => None,
        };
        Ok(FramePlan {
            wave,
            glow,
            textures,
            crowds,
        })
    }

    /// Plans single rays through a valid scene, without its volumes.
    pub(super) fn plan_rays(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        rays: &[Ray],
    ) -> Result<FramePlan> {
        let glow = self.glow.plan_rays(compute, scene, rays)?;
        self.has_glow = glow.is_some();
        self.has_wave = scene.source_count() > 0 || !self.has_glow;
        (self.has_textures, self.has_crowds) = (false, [false; 2]);
        let wave = match self.has_wave {
            true => Some(self.wave.plan_rays(compute, scene, rays)?),
            false => None,
        };
        Ok(FramePlan {
            wave,
            glow,
            textures: None,
            crowds: [None, None],
        })
    }

    /// Begins a frame of so many pixels.
    pub(super) fn begin(
        &mut self,
        compute: &Compute,
        plan: &FramePlan,
        pixels: usize,
    ) -> Result<()> {
        match &plan.wave {
            Some(wave) => self.wave.begin(compute, wave, pixels),
            None => Ok(()),
        }
    }

    /// Draws a band of pixels; the last launches may still be under way.
    pub(super) fn draw(
        &mut self,
        compute: &Compute,
        plan: &FramePlan,
        band: Range<u32>,
        film: &mut Film,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<()> {
        let draw_wave = |wave: &mut Wave, film: &mut Film| match &plan.wave {
            Some(it) => wave.draw(compute, it, band.clone(), film, progress),
            None => Ok(()),
        };
        self.draw_in_turn(compute, plan, band.clone(), film, false, draw_wave)
    }

    /// Draws all pixels without waiting for anything; with `is_unfinished` something is added to them afterwards.
    pub(super) fn draw_unwatched(
        &mut self,
        compute: &Compute,
        plan: &FramePlan,
        pixels: usize,
        film: &mut Film,
        is_unfinished: bool,
    ) -> Result<()> {
        let draw_wave = |wave: &mut Wave, film: &mut Film| match &plan.wave {
            Some(it) => wave.draw_unwatched(compute, it, film),
            None => Ok(()),
        };
        self.draw_in_turn(
            compute,
            plan,
            0..pixels as u32,
            film,
            is_unfinished,
            draw_wave,
        )
    }

    fn draw_in_turn(
        &mut self,
        compute: &Compute,
        plan: &FramePlan,
        band: Range<u32>,
        film: &mut Film,
        is_unfinished: bool,
        draw_wave: impl FnOnce(&mut Wave, &mut Film) -> Result<()>,
    ) -> Result<()> {
        let mut crowds = plan.crowds.iter().flatten().count();
        let is_followed = is_unfinished || plan.glow.is_some() || crowds > 0;
        film.leave_unfinished(is_followed || plan.textures.is_some());
        let mut drawn = draw_wave(&mut self.wave, film);
        if let (Some(textures), true) = (&plan.textures, drawn.is_ok()) {
            let turn = Turn {
                adds: plan.wave.is_some(),
                is_unfinished: is_followed,
            };
            drawn = self
                .textures
                .draw(compute, textures, band.clone(), film, turn);
            film.add_to_what_is_there(false);
        }
        film.leave_unfinished(is_unfinished || crowds > 0);
        if let (Some(glow), true) = (&plan.glow, drawn.is_ok()) {
            film.add_to_what_is_there(plan.wave.is_some() || plan.textures.is_some());
            drawn = self.glow.draw(compute, glow, band.clone(), film);
            film.add_to_what_is_there(false);
        }
        let mut adds = plan.wave.is_some() || plan.textures.is_some() || plan.glow.is_some();
        for (crowd, plan) in self.crowds.iter_mut().zip(&plan.crowds) {
            let (Some(plan), true) = (plan, drawn.is_ok()) else {
                continue;
            };
            crowds -= 1;
            film.leave_unfinished(is_unfinished || crowds > 0);
            film.add_to_what_is_there(adds);
            drawn = crowd.draw(compute, plan, band.clone(), film);
            film.add_to_what_is_there(false);
            adds = true;
        }
        film.leave_unfinished(false);
        drawn
    }

    /// Waits for the launches under way.
    pub(super) fn settle(&mut self, compute: &Compute, plan: &FramePlan) -> Result<()> {
        if let Some(wave) = &plan.wave {
            self.wave.settle(compute, wave)?;
        }
        if plan.textures.is_some() {
            self.textures.settle(compute)?;
        }
        for (crowd, plan) in self.crowds.iter_mut().zip(&plan.crowds) {
            if plan.is_some() {
                crowd.settle(compute)?;
            }
        }
        match plan.glow {
            Some(_) => self.glow.settle(compute),
            None => Ok(()),
        }
    }

    /// Waits for copies under way.
    pub(super) fn settle_uploads(&mut self, compute: &Compute) -> Result<()> {
        self.wave.settle_uploads(compute)
    }
}
