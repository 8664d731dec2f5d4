//! What a seed stands for: a liquid, what holds it, and how badly it is treated.

use glam::Vec3;
use oorandom::Rand64;

use super::corners;
use crate::{
    grid::Grid,
    scenes::GRAVITY_M_S2,
    solver::{Side, Sides, Walls},
    substance::Properties,
    vessel::Vessel,
};

/// Cells up to which everything that is drawn is in the same case.
const MOST_CELLS_OF_ALL: usize = 36_000;

/// Steps of a seed, before the liquid is left to come to rest.
pub const STEPS: usize = 200;

/// Longest edge of a drawn grid in cells.
pub const LONGEST_EDGE: usize = 96;

/// Fastest jerk, and fastest that a drawn CFL number may make the flow.
const FASTEST_M_S: f64 = 100.0;

/// Slowest flow that a drawn CFL number may stand for.
const SLOWEST_M_S: f64 = 1e-3;

/// Cells are from a micrometre to a metre wide: where between follows from CFL, step and speed.
const SPACING_M: [f64; 2] = [1e-6, 1.0];

/// One seed's torture.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What it is drawn from.
    pub seed: u64,
    /// The corner that it is, for the first eight seeds.
    pub corner: Option<&'static str>,
    /// The box of cells.
    pub grid: Grid,
    /// What holds the liquid.
    pub vessel: Vessel,
    /// The six sides of the box.
    pub sides: Sides,
    /// The walls of the pot, if it is one.
    pub walls: Walls,
    /// Density of the liquid.
    pub density_kg_m3: f32,
    /// Kinematic viscosity of the liquid.
    pub viscosity_m2_s: f32,
    /// Gravity, downwards.
    pub gravity_m_s2: f32,
    /// Cells that the first flow crosses in a step, summed over the axes.
    pub cfl: f64,
    /// Length of a step.
    pub dt_s: f64,
    /// Number of steps before the liquid is left alone.
    pub steps: usize,
    /// Change of the mean velocity around the probe that a jerk makes.
    pub jerk_m_s: f64,
    /// Steps from one jerk to the next.
    pub jerk_every: usize,
    /// Largest acceleration of the body force, which is on in every other block of eight steps.
    pub acceleration_m_s2: f64,
    /// What is poured and drained.
    pub substances: Vec<Substance>,
    /// A ball in the liquid that jumps to another place at once.
    pub obstacle: Option<Obstacle>,
}

/// A substance that is poured in at every even step, and drained at every odd one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substance {
    /// What it is like.
    pub properties: Properties,
    /// Rate of pouring times the length of a step; the first one's is the drain's, too.
    pub poured_per_step: f64,
}

/// A ball that jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Its radius.
    pub radius_m: f32,
    /// Steps from one jump to the next.
    pub jumps_every: usize,
}

impl Case {
    /// What `seed` stands for: a corner if it is below 8, a draw beyond.
    #[must_use]
    pub fn of_seed(seed: u64) -> Self {
        let drawn = draw(seed, &mut Rand64::new(u128::from(seed)));
        corners::of_seed(seed, drawn)
    }

    /// The speed that the CFL number stands for.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        self.cfl * f64::from(self.grid.spacing_m) / self.dt_s
    }

    /// Sets CFL number and step, and with them the cells' width: such that the speed they stand
    /// for is within a hand's reach, and `at` (0 to 1) between the least and the most there.
    pub fn set_scales(&mut self, cfl: f64, dt_s: f64, at: f64) {
        let narrowest = (SLOWEST_M_S * dt_s / cfl).max(SPACING_M[0]);
        let widest = (FASTEST_M_S * dt_s / cfl).min(SPACING_M[1]).max(narrowest);
        self.grid.spacing_m = (narrowest * (widest / narrowest).powf(at)) as f32;
        (self.cfl, self.dt_s) = (cfl, dt_s);
    }

    /// Sets the number of cells, and makes the pot fit, if it is one.
    pub fn set_cells(&mut self, cells: [usize; 3], is_pot: bool) {
        self.grid.cells = cells;
        self.vessel = if is_pot { pot_in(&self.grid) } else { Vessel::Box };
        if is_pot {
            // Only the top of the box touches the liquid of a pot.
            let top = self.sides.0[1][1];
            self.sides = Sides::of_vessel(self.walls);
            let is_alone = !matches!(top, Side::Periodic | Side::Inflow(_));
            self.sides.0[1][1] = if is_alone { top } else { Side::FreeSlip };
        }
    }

    /// Leaves out of large grids what needs many solves in each step: 50 seeds are to take
    /// minutes. No obstacle is in them, and substances are like the liquid.
    pub fn spare_large_grids(&mut self) {
        if self.grid.len() <= MOST_CELLS_OF_ALL {
            return;
        }
        self.obstacle = None;
        for Substance { properties, .. } in &mut self.substances {
            properties.density_kg_m3 = self.density_kg_m3;
            properties.viscosity_m2_s = self.viscosity_m2_s;
        }
    }

    /// What was drawn and describes the run, by name, for a row of figures.
    #[must_use]
    pub fn params(&self) -> Vec<(&'static str, f64)> {
        let [nx, ny, nz] = self.grid.cells.map(|n| n as f64);
        let sides = |is: fn(&Side) -> bool| self.sides.0.iter().flatten().filter(|s| is(s)).count();
        let densest = |ratio: f64, s: &Substance| {
            let own = f64::from(s.properties.density_kg_m3 / self.density_kg_m3);
            ratio.max(own).max(1.0 / own)
        };
        vec![
            ("cells_x", nx),
            ("cells_y", ny),
            ("cells_z", nz),
            ("spacing_m", f64::from(self.grid.spacing_m)),
            ("is_pot", f64::from(u8::from(self.vessel != Vessel::Box))),
            ("sides_no_slip", sides(|s| *s == Side::NoSlip) as f64),
            ("sides_moving", sides(|s| matches!(s, Side::Moving(_))) as f64),
            ("sides_inflow", sides(|s| matches!(s, Side::Inflow(_))) as f64),
            ("sides_outflow", sides(|s| *s == Side::Outflow) as f64),
            ("sides_periodic", sides(|s| *s == Side::Periodic) as f64),
            ("density_kg_m3", f64::from(self.density_kg_m3)),
            ("viscosity_m2_s", f64::from(self.viscosity_m2_s)),
            ("gravity_m_s2", f64::from(self.gravity_m_s2)),
            ("cfl", self.cfl),
            ("dt_s", self.dt_s),
            ("steps", self.steps as f64),
            ("jerk_m_s", self.jerk_m_s),
            ("jerk_every", self.jerk_every as f64),
            ("acceleration_m_s2", self.acceleration_m_s2),
            ("substances", self.substances.len() as f64),
            ("density_ratio", self.substances.iter().fold(1.0, densest)),
            ("obstacles", f64::from(u8::from(self.obstacle.is_some()))),
        ]
    }
}

/// A number between two, all magnitudes alike.
pub fn log_uniform(draws: &mut Rand64, [low, high]: [f64; 2]) -> f64 {
    low * (high / low).powf(draws.rand_float())
}

/// True in this share of cases.
pub fn chance(draws: &mut Rand64, share: f64) -> bool {
    draws.rand_float() < share
}

fn draw(seed: u64, draws: &mut Rand64) -> Case {
    // A thousand times as dense is still within what the crate takes.
    let density_kg_m3 = log_uniform(draws, [1.0, 1e3]) as f32;
    let viscosity = log_uniform(draws, [1e-7, 1e4]) as f32;
    let walls = if chance(draws, 0.5) { Walls::NoSlip } else { Walls::FreeSlip };
    let mut case = Case {
        seed,
        corner: None,
        grid: Grid { cells: [1; 3], spacing_m: 1.0, origin_in_world_m: Vec3::ZERO },
        vessel: Vessel::Box,
        sides: Sides::of_vessel(walls),
        walls,
        density_kg_m3,
        viscosity_m2_s: if chance(draws, 0.25) { 0.0 } else { viscosity },
        gravity_m_s2: GRAVITY_M_S2,
        cfl: 1.0,
        dt_s: 1.0,
        steps: STEPS,
        jerk_m_s: 0.0,
        jerk_every: [1, 7, 50][draws.rand_range(0..3) as usize],
        acceleration_m_s2: 0.0,
        substances: Vec::new(),
        obstacle: None,
    };
    let (cfl, dt_s) = (log_uniform(draws, [1e-2, 1e3]), log_uniform(draws, [1e-5, 1.0]));
    case.set_scales(cfl, dt_s, draws.rand_float());
    let speed_m_s = case.speed_m_s();
    // A jerk as fast as the flow keeps the CFL number that was drawn; half are as they come.
    let jerk_m_s = log_uniform(draws, [0.1, FASTEST_M_S]);
    case.jerk_m_s = if chance(draws, 0.5) { speed_m_s } else { jerk_m_s };
    let acceleration_m_s2 = speed_m_s / dt_s * log_uniform(draws, [1e-3, 1.0]);
    case.acceleration_m_s2 = if chance(draws, 0.5) { acceleration_m_s2.min(1e5) } else { 0.0 };
    let is_driven = chance(draws, 0.35);
    case.sides = Sides([(); 3].map(|()| both_sides(draws, is_driven, speed_m_s as f32)));
    let cells = cells(draws);
    case.set_cells(cells, chance(draws, 0.3));
    let substances = draws.rand_range(0..4);
    case.substances = (0..substances).map(|_| substance(draws, &case)).collect();
    case.obstacle = chance(draws, 0.5).then(|| obstacle(draws, &case));
    case.spare_large_grids();
    case
}

fn cells(draws: &mut Rand64) -> [usize; 3] {
    let edge = |draws: &mut Rand64| log_uniform(draws, [2.0, LONGEST_EDGE as f64 + 0.99]) as usize;
    let mut cells = [edge(draws), edge(draws), edge(draws)];
    if chance(draws, 0.2) {
        cells[draws.rand_range(0..3) as usize] = 1;
    }
    cells
}

fn both_sides(draws: &mut Rand64, is_driven: bool, speed_m_s: f32) -> [Side; 2] {
    if chance(draws, 0.2) {
        return [Side::Periodic; 2];
    }
    let velocity = direction(draws) * speed_m_s;
    if is_driven && chance(draws, 0.35) {
        let through = [Side::Inflow(velocity), Side::Outflow];
        return if chance(draws, 0.5) { through } else { [through[1], through[0]] };
    }
    [(); 2].map(|()| match draws.rand_float() {
        share if share < 0.45 => Side::NoSlip,
        share if is_driven && share < 0.75 => Side::Moving(velocity),
        share if share >= 0.94 => Side::Outflow,
        _ => Side::FreeSlip,
    })
}

/// A substance whose density is up to 1000 times that of the liquid, or a thousandth of it.
pub fn substance(draws: &mut Rand64, case: &Case) -> Substance {
    let cell_per_step = case.grid.spacing_m.powi(2) / case.dt_s as f32;
    let diffusivity = cell_per_step * log_uniform(draws, [1e-6, 1e2]) as f32;
    Substance {
        properties: Properties {
            density_kg_m3: case.density_kg_m3 * log_uniform(draws, [1e-3, 1e3]) as f32,
            viscosity_m2_s: log_uniform(draws, [1e-7, 1e4]) as f32,
            diffusivity_m2_s: if chance(draws, 0.5) { 0.0 } else { diffusivity },
        },
        poured_per_step: log_uniform(draws, [1e-3, 1e2]),
    }
}

/// A ball of one cell to a third of the box.
pub fn obstacle(draws: &mut Rand64, case: &Case) -> Obstacle {
    let widest = f64::from(case.grid.extent_m().max_element()) / 6.0;
    let narrowest = f64::from(case.grid.spacing_m).min(widest);
    Obstacle {
        radius_m: log_uniform(draws, [narrowest, widest]) as f32,
        jumps_every: [1, 10, 50][draws.rand_range(0..3) as usize],
    }
}

/// A direction, none preferred by much.
pub fn direction(draws: &mut Rand64) -> Vec3 {
    let mut component = || draws.rand_float() as f32 * 2.0 - 1.0;
    Vec3::new(component(), component(), component()).normalize_or(Vec3::X)
}

/// A pot that nearly fills the box.
fn pot_in(grid: &Grid) -> Vessel {
    let extent_m = grid.extent_m();
    let radius_m = 0.47 * extent_m.x.min(extent_m.z);
    let centre = 0.5 * extent_m;
    let centre_in_world_m = grid.origin_in_world_m + centre.with_y(centre.y.min(1.05 * radius_m));
    Vessel::Pot { centre_in_world_m, radius_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_keep_to_their_ranges_and_reach_both_ends() {
        let cases: Vec<_> = (8..2000).map(Case::of_seed).collect();
        let within = |value: fn(&Case) -> f64, [low, high]: [f64; 2]| {
            let values: Vec<_> = cases.iter().map(value).collect();
            let (least, most) = values.iter().fold((f64::MAX, 0f64), |(least, most), value| {
                (least.min(*value), most.max(*value))
            });
            assert!(least >= low * 0.999 && most <= high * 1.001, "{least} {most}");
            assert!(least <= low * 2.0 && most >= high / 2.0, "{least} {most}");
        };
        within(|case| case.cfl, [1e-2, 1e3]);
        within(|case| case.dt_s, [1e-5, 1.0]);
        within(|case| case.jerk_m_s, [SLOWEST_M_S, FASTEST_M_S]);
        within(|case| case.speed_m_s(), [SLOWEST_M_S, FASTEST_M_S]);
        within(|case| *case.grid.cells.iter().max().expect("three") as f64, [2.0, 96.0]);
        within(|case| f64::from(case.viscosity_m2_s).max(1e-7), [1e-7, 1e4]);
        let share = |is: fn(&Case) -> bool| {
            cases.iter().filter(|case| is(case)).count() as f64 / cases.len() as f64
        };
        assert!((0.2..0.3).contains(&share(|case| case.viscosity_m2_s == 0.0)));
        assert!((0.1..0.3).contains(&share(|case| case.grid.cells.contains(&1))));
        assert!((0.2..0.4).contains(&share(|case| case.vessel != Vessel::Box)));
        assert!((0.1..0.4).contains(&share(|case| case.sides.drive())));
        for case in &cases {
            let [nx, ny, nz] = case.grid.cells;
            assert_eq!(case.sides.check([ny * nz, nx * nz, nx * ny]), Ok(()), "{case:?}");
        }
    }

    #[test]
    fn a_seed_stands_for_one_case() {
        assert_eq!(Case::of_seed(77), Case::of_seed(77));
        assert_ne!(Case::of_seed(77).cfl, Case::of_seed(78).cfl);
    }
}
