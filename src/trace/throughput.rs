//! What is left of light on its way along a path, in the two parts that fog tells apart.

use super::tracer::Way;
use crate::color::Rgb;

/// How much of the light that a path meets reaches its eye. Fog dims what a surface shows by reflection or
/// refraction, but not what it gathers: the light of lamps, glowing objects and the sky comes to its diffuse lobe as
/// if there were none. So which lobe the path has left its last surface by decides what the fog since then counts.
#[derive(Clone, Copy, Debug)]
pub struct Throughput {
    /// Of what the last surface that scattered gathers.
    gathers: Rgb,
    /// Of what it shows.
    shows: Rgb,
    /// The share of light that the fog since that surface lets pass.
    clear: f32,
}

impl Throughput {
    /// Of a ray that only shows what it meets, as those from the eye do.
    pub fn showing(share: Rgb) -> Self {
        Self { gathers: Rgb::ZERO, shows: share, clear: 1.0 }
    }

    /// Begins as that of a ray from the eye. Number by number: what is put together elsewhere has to be waited for.
    #[inline(always)]
    pub fn begin(&mut self) {
        (self.gathers.x, self.gathers.y, self.gathers.z) = (0.0, 0.0, 0.0);
        (self.shows.x, self.shows.y, self.shows.z) = (1.0, 1.0, 1.0);
        self.clear = 1.0;
    }

    /// Of what surfaces send to the eye because something shines on them: fog dims it all.
    pub fn seen(&self) -> Rgb {
        (self.gathers + self.shows) * self.clear
    }

    /// Of what shines by itself.
    pub fn shining(&self) -> Rgb {
        self.gathers + self.shown()
    }

    /// The part that fog dims, and whose way is filled with its glow right up to what shines.
    pub fn shown(&self) -> Rgb {
        self.shows * self.clear
    }

    /// Goes a way.
    pub fn go(&mut self, way: Way) {
        self.dim(way.passed);
        self.clear *= way.clear;
    }

    /// Passes something that neither scatters nor bends.
    pub fn dim(&mut self, share: Rgb) {
        self.gathers *= share;
        self.shows *= share;
    }

    /// Goes on although it had only this chance to.
    pub fn make_up_for(&mut self, chance: f32) {
        self.gathers /= chance;
        self.shows /= chance;
    }

    /// Leaves a surface, which gathers and shows these shares.
    pub fn leave(&mut self, gathers: Rgb, shows: Rgb) {
        let seen = self.seen();
        *self = Self { gathers: seen * gathers, shows: seen * shows, clear: 1.0 };
    }
}
