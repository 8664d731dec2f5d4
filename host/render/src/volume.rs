//! The liquid and what was poured into it, or the smoke above it: a field of light and extinction,
//! marched by rays.

use cauldron_fluid::{Grid, SmokeView, Snapshot};
use glam::{Vec3, Vec4, Vec4Swizzles};

use crate::{
    camera::Ray,
    film::{self, Film},
    solid,
    surface::Surface,
    unit,
};

/// Extinction of a pure substance: 8 mm hide 60 % of what lies behind.
const POURED_PER_M: f32 = 120.0;
/// Extinction of pure smoke: thick where it comes out, and still seen where it has thinned.
const SMOKE_PER_M: f32 = 30.0;
/// Extinction of the clear liquid: a pot 0.25 m wide hides 40 % of its far wall.
const CLEAR_PER_M: f32 = 2.0;
/// Part of the substances' extinction that dims the lamp for what lies below them.
const SHADOW: f32 = 0.045;
/// Light that reaches the bottom of a black potion all the same.
const AMBIENT: f32 = 0.45;
/// Step of the march, in cells: the long one where no cell hides more than `THIN` of what lies
/// behind it, for there it makes no difference that could be seen.
const STEP_CELLS: f32 = 0.5;
const LONG_STEP_CELLS: f32 = 1.0;
const THIN: f32 = 0.15;
/// No ray takes more steps, whatever the grid.
const MOST_STEPS: f32 = 4096.0;

/// What fills the vessel.
pub(crate) struct Volume {
    grid: Grid,
    /// What a step of `step_m` in each cell adds (`xyz`) and hides (`w`).
    sheets: Vec<Vec4>,
    step_m: f32,
    /// Light (`xyz`) and extinction (`w`) of the clear liquid, per metre.
    clear: Vec4,
    /// Box around all that was poured, world metres.
    poured_in_world_m: Option<[Vec3; 2]>,
}

impl Volume {
    /// The field of `snapshot`. `depth_inside_m` tells the vessel's hollow from its wall.
    pub(crate) fn new(snapshot: &Snapshot, depth_inside_m: impl Fn(Vec3) -> f32) -> Self {
        let grid = snapshot.grid;
        let clear = match snapshot.liquid_colour {
            // Light goes down through the liquid and up again, and takes on its colour twice.
            Some(colour) if colour.is_finite() => CLEAR_PER_M * (colour * colour).extend(1.0),
            _ => Vec4::ZERO,
        };
        let has_place = grid.spacing_m > 0.0 && grid.extent_m().is_finite();
        let mut mixture = if has_place { mix(snapshot) } else { Vec::new() };
        if poured_box(&grid, &mixture).is_some() {
            spread_into_wall(&grid, &mut mixture, depth_inside_m);
        }
        Self::of_mixture(grid, &mixture, clear, POURED_PER_M)
    }

    /// The field of smoke. One that does not fit its grid, or has no colour, counts as none.
    pub(crate) fn of_smoke(smoke: &SmokeView) -> Self {
        let (grid, colour) = (smoke.grid, smoke.colour.extend(1.0));
        let has_place = grid.spacing_m > 0.0 && grid.extent_m().is_finite();
        let is_whole = has_place && smoke.fraction.len() == grid.len() && colour.is_finite();
        let fraction: &[f32] = if is_whole { &smoke.fraction } else { &[] };
        let mixture: Vec<Vec4> = fraction.iter().map(|part| unit(*part) * colour).collect();
        Self::of_mixture(grid, &mixture, Vec4::ZERO, SMOKE_PER_M)
    }

    fn of_mixture(grid: Grid, mixture: &[Vec4], clear: Vec4, poured_per_m: f32) -> Self {
        let poured_in_world_m = poured_box(&grid, mixture);
        if poured_in_world_m.is_none() {
            return Self { grid, sheets: Vec::new(), step_m: 0.0, clear, poured_in_world_m };
        }
        let mut sheets = lit_from_above(&grid, mixture, clear, poured_per_m);
        let thickest_per_m = sheets.iter().map(|medium| medium.w).fold(0.0, f32::max);
        let is_thin = thickest_per_m * grid.spacing_m < THIN;
        let step_m = grid.spacing_m * if is_thin { LONG_STEP_CELLS } else { STEP_CELLS };
        sheets.iter_mut().for_each(|medium| *medium = film::through(*medium, step_m));
        Self { grid, sheets, step_m, clear, poured_in_world_m }
    }

    /// True if there is nothing to march through.
    pub(crate) fn is_empty(&self) -> bool {
        self.clear == Vec4::ZERO && self.poured_in_world_m.is_none()
    }

    /// Gathers what `ray` sees of it within `span_m`; `surface` is what it lies
    /// under or above, and is moved by.
    pub(crate) fn march(
        &self,
        ray: &Ray,
        span_m: [f32; 2],
        surface: Option<&Surface>,
        film: &mut Film,
    ) {
        let Some(poured_m) = self.poured_span_m(ray, span_m, surface) else {
            return film.medium(self.clear, span_m[1] - span_m[0]);
        };
        film.medium(self.clear, poured_m[0] - span_m[0]);
        let steps = (poured_m[1] - poured_m[0]) / self.step_m;
        for step in 0..steps.ceil().min(MOST_STEPS) as u32 {
            // The last step may be shorter than the others.
            let part = (steps - step as f32).min(1.0);
            let along_m = poured_m[0] + (step as f32 + 0.5 * part) * self.step_m;
            let point_in_world_m = ray.at(along_m);
            let at_rest = surface.map_or(point_in_world_m, |s| s.at_rest(point_in_world_m));
            let sheet = part * self.sample(at_rest);
            film.sheet(sheet.xyz(), sheet.w);
            if film.is_opaque() {
                return;
            }
        }
        film.medium(self.clear, span_m[1] - poured_m[1]);
    }

    /// The part of the span where there may be more than clear liquid.
    pub(crate) fn poured_span_m(
        &self,
        ray: &Ray,
        span_m: [f32; 2],
        surface: Option<&Surface>,
    ) -> Option<[f32; 2]> {
        let [low_m, high_m] = self.poured_in_world_m?;
        let moved_m = Vec3::Y * surface.map_or(0.0, Surface::greatest_move_m);
        solid::common(span_m, solid::span_in_box_m(ray, low_m - moved_m, high_m + moved_m)?)
    }

    /// The field at a point, trilinear between cell centres, constant beyond the outermost.
    fn sample(&self, point_in_world_m: Vec3) -> Vec4 {
        let [nx, ny, nz] = self.grid.cells;
        let last = Vec3::new(nx as f32, ny as f32, nz as f32) - 1.0;
        let from_origin_m = point_in_world_m - self.grid.origin_in_world_m;
        let at = (from_origin_m / self.grid.spacing_m - 0.5).max(Vec3::ZERO).min(last);
        let low = at.as_uvec3();
        let part = at - low.as_vec3();
        let [i, j, k] = low.to_array().map(|axis| axis as usize);
        let (dx, dy, dz) = (
            usize::from(i + 1 < nx),
            if j + 1 < ny { nx } else { 0 },
            if k + 1 < nz { nx * ny } else { 0 },
        );
        let corner = self.grid.cell(i, j, k);
        let along_x = |at: usize| self.sheets[at].lerp(self.sheets[at + dx], part.x);
        let along_y = |at: usize| along_x(at).lerp(along_x(at + dy), part.y);
        along_y(corner).lerp(along_y(corner + dz), part.z)
    }
}

/// Per cell, the substances' colours weighted with their fractions (`xyz`), and the sum of the
/// fractions (`w`). Weighted sums are what makes red and green an orange yellow. Empty if nothing
/// was poured; a substance that does not fit the grid, or has no colour, counts as not poured.
fn mix(snapshot: &Snapshot) -> Vec<Vec4> {
    let mut mixture = Vec::new();
    for substance in &snapshot.substances {
        let cells = substance.fraction.len();
        if cells != snapshot.grid.len() || !substance.colour.is_finite() {
            continue;
        }
        mixture.resize(cells, Vec4::ZERO);
        let colour = substance.colour.extend(1.0);
        for (sum, fraction) in mixture.iter_mut().zip(&substance.fraction) {
            *sum += unit(*fraction) * colour;
        }
    }
    mixture
}

/// Box around the centres of all cells that hold a substance, one cell wider on every side.
fn poured_box(grid: &Grid, mixture: &[Vec4]) -> Option<[Vec3; 2]> {
    const TRACE: f32 = 1e-4;
    // Nothing poured, no mixture: then there is no cell to look at either.
    let poured = cells(grid).zip(mixture).filter(|(_, sum)| sum.w > TRACE);
    let bounds = poured.fold(None, |bounds, ([i, j, k], _)| {
        let centre_in_world_m = grid.centre_in_world_m(i, j, k);
        let [low, high]: [Vec3; 2] = bounds.unwrap_or([centre_in_world_m; 2]);
        Some([low.min(centre_in_world_m), high.max(centre_in_world_m)])
    });
    bounds.map(|[low, high]| [low - grid.spacing_m, high + grid.spacing_m])
}

/// Gives the cells in the wall the mean of their neighbours in the hollow. They hold nothing of
/// their own, and interpolating towards that would wrap every potion in a clear skin.
fn spread_into_wall(grid: &Grid, mixture: &mut [Vec4], depth_inside_m: impl Fn(Vec3) -> f32) {
    let in_hollow: Vec<bool> = cells(grid)
        .map(|[i, j, k]| depth_inside_m(grid.centre_in_world_m(i, j, k)) > 0.0)
        .collect();
    let wall: Vec<(usize, Vec4)> = cells(grid)
        .filter(|at| !in_hollow[grid.cell(at[0], at[1], at[2])])
        .map(|at| (grid.cell(at[0], at[1], at[2]), mean_around(grid, mixture, &in_hollow, at)))
        .collect();
    for (cell, mean) in wall {
        mixture[cell] = mean;
    }
}

/// Mean of the cells around `at` that are `in_hollow`; zero if none is.
fn mean_around(grid: &Grid, mixture: &[Vec4], in_hollow: &[bool], at: [usize; 3]) -> Vec4 {
    let around = |axis: usize| at[axis].saturating_sub(1)..(at[axis] + 2).min(grid.cells[axis]);
    let (mut sum, mut count) = (Vec4::ZERO, 0.0_f32);
    for (k, j) in around(2).flat_map(|k| around(1).map(move |j| (k, j))) {
        for cell in around(0).map(|i| grid.cell(i, j, k)).filter(|cell| in_hollow[*cell]) {
            sum += mixture[cell];
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}

/// Light and extinction of each cell of a mixture in clear liquid, lit down its column.
fn lit_from_above(grid: &Grid, mixture: &[Vec4], clear: Vec4, poured_per_m: f32) -> Vec<Vec4> {
    let mut medium = vec![Vec4::ZERO; mixture.len()];
    let [nx, ny, nz] = grid.cells;
    for (i, k) in (0..nz).flat_map(|k| (0..nx).map(move |i| (i, k))) {
        let mut above = 0.0_f32;
        for cell in (0..ny).rev().map(|j| grid.cell(i, j, k)) {
            let sum = mixture[cell];
            // More than a full cell is a fault of the solver's, not more colour.
            let full = sum.w.max(1.0);
            let poured = poured_per_m * sum / full;
            let light = AMBIENT + (1.0 - AMBIENT) * (-SHADOW * above).exp();
            above += poured.w * grid.spacing_m;
            medium[cell] = clear * (1.0 - sum.w / full) + (light * poured.xyz()).extend(poured.w);
        }
    }
    medium
}

/// All cells, in the order in which they are stored.
fn cells(grid: &Grid) -> impl Iterator<Item = [usize; 3]> + use<> {
    let [nx, ny, nz] = grid.cells;
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { cells: [2, 3, 1], spacing_m: 1.0, origin_in_world_m: Vec3::ZERO };

    #[test]
    fn cells_come_in_the_order_of_the_grid() {
        assert!(cells(&GRID).map(|[i, j, k]| GRID.cell(i, j, k)).eq(0..GRID.len()));
    }

    #[test]
    fn the_wall_takes_what_the_hollow_beside_it_has() {
        let mut mixture = [1.0, 9.0, 2.0, 9.0, 3.0, 9.0].map(Vec4::splat);
        spread_into_wall(&GRID, &mut mixture, |centre| 1.0 - centre.x);
        let spread = [1.5, 2.0, 2.5].map(Vec4::splat);
        assert_eq!([mixture[1], mixture[3], mixture[5]], spread);
        assert_eq!(mixture[2], Vec4::splat(2.0));
    }

    #[test]
    fn it_is_darker_below_what_is_poured_and_clear_where_nothing_is() {
        let clear = Vec4::new(0.1, 0.2, 0.3, 1.0);
        let full = Vec4::new(0.9, 0.0, 0.0, 1.0);
        let column = [full, Vec4::ZERO, full, Vec4::ZERO, full, Vec4::ZERO];
        let medium = lit_from_above(&GRID, &column, clear, POURED_PER_M);
        assert!(medium[4].x > medium[2].x && medium[2].x > medium[0].x);
        assert_eq!(medium[5], clear);
    }
}
