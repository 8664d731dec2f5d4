//! What a seed stands for: a surface, what it lies on, and how badly it is treated.

use glam::Vec3;
use oorandom::Rand64;

use super::corners;
use crate::{
    grid::Grid,
    surface::{INDEX, SurfaceParams},
    torture::draw::{chance, log_uniform},
    vessel::Vessel,
};

/// Steps of a small surface, before it is left alone.
const STEPS: usize = 200;

/// Nodes of all steps together, or large surfaces would take most of the time.
const MOST_NODES: usize = 1 << 21;

/// Cells along an edge of the liquid below, where there is any to splash into.
const SPLASH_CELLS: usize = 10;

/// Steps that nobody asks for, and that have to be taken.
const STRANGE_DT_S: [f64; 2] = [1e-9, 1e3];

/// One seed's torture.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What it is drawn from.
    pub seed: u64,
    /// The corner that it is, for the first seeds.
    pub corner: Option<&'static str>,
    /// What the surface is made of.
    pub params: SurfaceParams,
    /// The box of cells below it.
    pub grid: Grid,
    /// What holds the liquid.
    pub vessel: Vessel,
    /// Density of the liquid.
    pub density_kg_m3: f32,
    /// Kinematic viscosity of the liquid.
    pub viscosity_m2_s: f32,
    /// Gravity, downwards.
    pub gravity_m_s2: f32,
    /// Length of a step.
    pub dt_s: f32,
    /// Number of steps before it is left alone.
    pub steps: usize,
    /// Largest force of a poke.
    pub poke_n: f64,
    /// Largest resistance of a poke.
    pub damping_n_s_per_m: f64,
    /// Largest energy of a kick.
    pub kick_j: f64,
    /// Largest pressure from below.
    pub press_pa: f64,
    /// Largest height of a jump.
    pub jump_m: f64,
    /// Whether drops leave it and fall into a liquid.
    pub splashes: bool,
}

impl Case {
    /// What `seed` stands for: a corner if it is one of the first, a draw beyond.
    #[must_use]
    pub fn of_seed(seed: u64) -> Self {
        let drawn = draw(seed, &mut Rand64::new(u128::from(seed) | (1 << 90)));
        corners::of_seed(seed, drawn)
    }

    /// Nodes along x and z.
    #[must_use]
    pub fn nodes(&self) -> [usize; 2] {
        let [nx, _, nz] = self.grid.cells;
        [nx, nz].map(|cells| cells * self.params.nodes_per_cell)
    }

    /// Sets the nodes, about as many as are asked for where drops need a liquid of few cells, and
    /// the way between them; and makes the pot fit, if it is one.
    pub fn set_nodes(&mut self, nodes: [usize; 2], spacing_m: f32, is_pot: bool) {
        let most = nodes.into_iter().max().unwrap_or(1);
        let per_cell = if self.splashes { most.div_ceil(SPLASH_CELLS).min(16) } else { 1 };
        let [nx, nz] = nodes.map(|n| (n / per_cell).max(2));
        self.params.nodes_per_cell = per_cell;
        let cells = [nx, if self.splashes { 4 } else { 1 + nx.min(nz) / 2 }, nz];
        self.grid.cells = cells;
        self.grid.spacing_m = spacing_m * per_cell as f32;
        let extent_m = self.grid.extent_m();
        let radius_m = 0.47 * extent_m.x.min(extent_m.z);
        let centre_in_world_m = (0.5 * extent_m).with_y(extent_m.y.min(1.05 * radius_m));
        let pot = Vessel::Pot { centre_in_world_m, radius_m };
        self.vessel = if is_pot { pot } else { Vessel::Box };
        let [nx, nz] = self.nodes();
        self.steps = (MOST_NODES / (nx * nz)).clamp(24, STEPS);
    }

    /// Depth of the box.
    #[must_use]
    pub fn depth_m(&self) -> f64 {
        f64::from(self.grid.extent_m().y)
    }

    /// Way from one node to the next.
    #[must_use]
    pub fn spacing_m(&self) -> f64 {
        f64::from(self.grid.spacing_m) / self.params.nodes_per_cell as f64
    }

    /// What was drawn and describes the run, by name, for a row of figures.
    #[must_use]
    pub fn figures(&self) -> Vec<(&'static str, f64)> {
        let [nodes_x, nodes_z] = self.nodes().map(|n| n as f64);
        vec![
            ("nodes_x", nodes_x),
            ("nodes_z", nodes_z),
            ("spacing_m", self.spacing_m()),
            ("depth_m", self.depth_m()),
            ("is_pot", f64::from(u8::from(self.vessel != Vessel::Box))),
            ("splashes", f64::from(u8::from(self.splashes))),
            ("density_kg_m3", self.density_kg_m3.into()),
            ("viscosity_m2_s", self.viscosity_m2_s.into()),
            ("gravity_m_s2", self.gravity_m_s2.into()),
            ("areal_mass_kg_m2", self.params.areal_mass_kg_m2.into()),
            ("gravity_n_per_m3", self.params.gravity_n_per_m3.into()),
            ("tension_n_per_m", self.params.tension_n_per_m.into()),
            ("bend", self.params.bend.into()),
            ("drag_n_s_per_m3", self.params.drag_n_s_per_m3.into()),
            ("dt_s", self.dt_s.into()),
            ("steps", self.steps as f64),
            ("poke_n", self.poke_n),
            ("damping_n_s_per_m", self.damping_n_s_per_m),
            ("kick_j", self.kick_j),
            ("press_pa", self.press_pa),
            ("jump_m", self.jump_m),
        ]
    }
}

/// One of these magnitudes, or nothing at all in some cases.
fn or_none(draws: &mut Rand64, none: f64, range: [f64; 2]) -> f64 {
    let drawn = log_uniform(draws, range);
    if chance(draws, none) { 0.0 } else { drawn }
}

fn draw(seed: u64, draws: &mut Rand64) -> Case {
    let model = INDEX[draws.rand_range(0..INDEX.len() as u64) as usize].name;
    let density_kg_m3 = log_uniform(draws, [1.0, 1e4]) as f32;
    let gravity_m_s2 = or_none(draws, 0.1, [1e-2, 1e3]) as f32;
    let params = SurfaceParams {
        model,
        areal_mass_kg_m2: log_uniform(draws, [1e-1, 1e4]) as f32,
        gravity_n_per_m3: density_kg_m3 * gravity_m_s2,
        tension_n_per_m: or_none(draws, 0.1, [1e-3, 1e7]) as f32,
        bend: or_none(draws, 0.5, [1e-3, 10.0]) as f32,
        drag_n_s_per_m3: or_none(draws, 0.3, [1e-3, 1e7]) as f32,
        tear_speed_m_s: log_uniform(draws, [0.1, 10.0]) as f32,
        ..SurfaceParams::WATER
    };
    let mut case = Case {
        seed,
        corner: None,
        params,
        grid: Grid { cells: [1; 3], spacing_m: 1.0, origin_in_world_m: Vec3::ZERO },
        vessel: Vessel::Box,
        density_kg_m3,
        viscosity_m2_s: or_none(draws, 0.25, [1e-7, 1e4]) as f32,
        gravity_m_s2,
        dt_s: log_uniform(draws, [1e-5, 1.0]) as f32,
        steps: STEPS,
        poke_n: log_uniform(draws, [1e-3, 1e4]),
        damping_n_s_per_m: or_none(draws, 0.5, [1e-3, 1e7]),
        kick_j: or_none(draws, 0.3, [1e-6, 1e3]),
        press_pa: or_none(draws, 0.3, [1e-3, 1e5]),
        jump_m: or_none(draws, 0.3, [1e-6, 1.0]),
        splashes: chance(draws, 0.3),
    };
    let mut edge = || log_uniform(draws, [2.0, 256.99]) as usize;
    let nodes = [edge(), edge()];
    let spacing_m = log_uniform(draws, [1e-4, 0.1]) as f32;
    case.set_nodes(nodes, spacing_m, chance(draws, 0.25));
    if chance(draws, 0.2) {
        case.dt_s = log_uniform(draws, STRANGE_DT_S) as f32;
    }
    case
}
