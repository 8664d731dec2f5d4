//! The first eight seeds: fixed corners of what can be drawn.

use super::draw::{Case, LONGEST_EDGE, Obstacle, Substance};
use crate::{
    solver::{Sides, Walls},
    substance::Properties,
};

/// One corner.
struct Corner {
    name: &'static str,
    cells: [usize; 3],
    is_pot: bool,
    walls: Walls,
    viscosity_m2_s: f32,
    cfl: f64,
    dt_s: f64,
    /// Where between the narrowest and the widest cell that these allow for.
    width: f64,
    jerk_m_s: f64,
    jerk_every: usize,
    /// Of the force, in units of what would double the speed in one step.
    acceleration: f64,
}

/// A corner that is nowhere extreme.
const TAME: Corner = Corner {
    name: "tame",
    cells: [32; 3],
    is_pot: false,
    walls: Walls::NoSlip,
    viscosity_m2_s: 1e-4,
    cfl: 0.5,
    dt_s: 1e-2,
    width: 0.7,
    jerk_m_s: 1.0,
    jerk_every: 7,
    acceleration: 0.1,
};

/// Seeds 0 to 7.
const CORNERS: [Corner; 8] = [
    Corner {
        name: "96^3",
        cells: [LONGEST_EDGE; 3],
        cfl: 0.1,
        jerk_m_s: 0.1,
        jerk_every: 50,
        acceleration: 0.01,
        ..TAME
    },
    Corner { name: "cfl-1000", cfl: 1e3, jerk_m_s: 100.0, ..TAME },
    Corner { name: "dt-1s", is_pot: true, dt_s: 1.0, cfl: 10.0, ..TAME },
    Corner { name: "inviscid", is_pot: true, viscosity_m2_s: 0.0, ..TAME },
    Corner { name: "2^3", cells: [2; 3], jerk_m_s: 100.0, jerk_every: 1, ..TAME },
    Corner { name: "one-cell-thin", cells: [48, 32, 1], ..TAME },
    // From the longest edge to a thin one, so that it takes seconds: 96^3 has its own corner.
    Corner {
        name: "all-at-once",
        cells: [LONGEST_EDGE, 48, 2],
        viscosity_m2_s: 0.0,
        cfl: 1e3,
        dt_s: 1.0,
        jerk_m_s: 100.0,
        jerk_every: 1,
        ..TAME
    },
    // The other end of viscosity: nu dt / h^2 is 1e8 and more, where explicit terms overflow
    // f32 and an implicit solve is worst conditioned; in a pot, whose walls leave it no
    // transform to solve with; shaken at 100 m/s, of which nothing may be left.
    Corner {
        name: "stiffest",
        is_pot: true,
        viscosity_m2_s: 1e4,
        dt_s: 1.0,
        width: 0.1,
        jerk_m_s: 100.0,
        jerk_every: 1,
        ..TAME
    },
];

/// Number of corners.
pub const COUNT: u64 = CORNERS.len() as u64;

/// Name of the corner that a seed is.
#[must_use]
pub fn name(seed: u64) -> Option<&'static str> {
    CORNERS.get(seed as usize).map(|corner| corner.name)
}

/// The corner of a seed; `drawn` beyond the corners.
pub fn of_seed(seed: u64, drawn: Case) -> Case {
    let Some(corner) = CORNERS.get(seed as usize) else { return drawn };
    let mut case = Case {
        corner: Some(corner.name),
        sides: Sides::of_vessel(corner.walls),
        walls: corner.walls,
        density_kg_m3: 1000.0,
        viscosity_m2_s: corner.viscosity_m2_s,
        jerk_m_s: corner.jerk_m_s,
        jerk_every: corner.jerk_every,
        ..drawn
    };
    case.set_scales(corner.cfl, corner.dt_s, corner.width);
    case.set_cells(corner.cells, corner.is_pot);
    case.acceleration_m_s2 = corner.acceleration * case.speed_m_s() / corner.dt_s;
    // A thousand times as dense as the liquid, or a thousandth: every other corner each.
    let ratio = [1e3, 1e-3][seed as usize % 2];
    case.substances = vec![Substance {
        properties: Properties {
            density_kg_m3: 1000.0 * ratio,
            viscosity_m2_s: 1e-2,
            diffusivity_m2_s: 0.0,
        },
        poured_per_step: 0.1,
    }];
    let radius_m = 0.1 * case.grid.extent_m().max_element();
    case.obstacle = Some(Obstacle { radius_m, jumps_every: corner.jerk_every });
    case.spare_large_grids();
    case
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_are_where_they_are_said_to_be() {
        let cases: Vec<_> = (0..COUNT).map(Case::of_seed).collect();
        assert!(cases.iter().all(|case| case.corner.is_some() && case.steps >= 200));
        assert_eq!(Case::of_seed(COUNT).corner, None);
        assert_eq!(cases[0].grid.cells, [96; 3]);
        assert_eq!((cases[1].cfl, cases[2].dt_s, cases[3].viscosity_m2_s), (1e3, 1.0, 0.0));
        assert_eq!((cases[4].grid.cells, cases[5].grid.cells[2]), ([2; 3], 1));
        let all = &cases[6];
        assert_eq!((all.grid.cells, all.cfl, all.dt_s), ([96, 48, 2], 1e3, 1.0));
        assert_eq!((all.viscosity_m2_s, all.jerk_m_s, all.jerk_every), (0.0, 100.0, 1));
        assert_eq!(all.obstacle.expect("one").jumps_every, 1);
        let stiffest = &cases[7];
        let number = f64::from(stiffest.viscosity_m2_s) * stiffest.dt_s
            / f64::from(stiffest.grid.spacing_m).powi(2);
        assert!(number > 1e7, "{number}");
    }
}
