//! Liquids that are not the same everywhere, against closed forms.

use std::f64::consts::PI;

use cauldron_fluid::{
    Grid, Vessel,
    solver::{
        Setup, Solver, Walls,
        flow::{Flow, Medium},
    },
};
use glam::{DVec3, Vec3};

/// A closed box or pot with gravity along -y.
fn heavy(n: usize, vessel: Vessel) -> Setup {
    let gravity_m_s2 = Vec3::new(0.0, -10.0, 0.0);
    Setup { gravity_m_s2, ..Setup::new(Grid::unit_cube(n), vessel) }
}

fn pot() -> Vessel {
    Vessel::Pot { centre_in_world_m: Vec3::new(0.5, 0.55, 0.5), radius_m: 0.47 }
}

fn inviscid(density_kg_m3: f64) -> Medium {
    Medium { density_kg_m3, viscosity_m2_s: 0.0 }
}

#[test]
fn level_layers_stay_at_rest_to_the_last_bit_and_sleep() {
    for vessel in [Vessel::Box, pot()] {
        let setup = heavy(12, vessel);
        let setup = Setup { viscosity_m2_s: 1e-3, walls: Walls::NoSlip, ..setup };
        let mut flow = Flow::new(&setup).expect("a flow");
        // Light on top and heavy on top alike: nothing disturbs them.
        for slope in [-90.0, 90.0] {
            flow.set_medium(&|p| inviscid(1000.0 + slope * p.y * p.y)).expect("in range");
            for _ in 0..20 {
                let report = flow.step(0.02).expect("in range");
                assert!(report.asleep && report.guard_actions == 0);
            }
            assert_eq!(flow.kinetic_energy_j(), 0.0);
        }
    }
}

#[test]
fn a_small_difference_of_density_accelerates_as_its_mode_does() {
    // Of b = B cos(pi x) sin(pi y) along y, half is free of divergence: the rest is pressure.
    for (n, allowed) in [(8, 0.02), (16, 0.005)] {
        let mut flow = Flow::new(&heavy(n, Vessel::Box)).expect("a flow");
        let share = |p: DVec3| 0.05 * (PI * p.x).cos() * (PI * p.y).sin();
        flow.set_medium(&|p| inviscid(1000.0 * (1.0 + share(p)))).expect("in range");
        let (dt_s, steps) = (1e-3, 5);
        let mut guard_actions = 0;
        for _ in 0..steps {
            guard_actions += flow.step(dt_s).expect("in range").guard_actions;
        }
        let mut worst = 0f64;
        flow.visit(&mut |p, c, value| {
            let (x, y) = (PI * p.x, PI * p.y);
            let mode = DVec3::new(x.sin() * y.cos(), -x.cos() * y.sin(), 0.0);
            let exact = 0.5 * 10.0 * 0.05 * dt_s * f64::from(steps) * mode[c];
            worst = worst.max((value - exact).abs());
        });
        let fastest = 0.25 * dt_s * f64::from(steps);
        assert!(worst < allowed * fastest, "{n}: {}", worst / fastest);
        assert_eq!(guard_actions, 0);
    }
}

#[test]
fn what_is_the_same_everywhere_changes_no_bits() {
    let run = |sets: bool| {
        let setup = Setup { viscosity_m2_s: 0.01, ..heavy(8, pot()) };
        let mut flow = Flow::new(&setup).expect("a flow");
        let wild = |p: DVec3| DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).cos(), (8.0 * p.x).sin());
        flow.set_velocity(&wild).expect("finite");
        let mut bits = Vec::new();
        for _ in 0..4 {
            if sets {
                let viscosity_m2_s = f64::from(setup.viscosity_m2_s);
                flow.set_medium(&|_| Medium { density_kg_m3: 1000.0, viscosity_m2_s })
                    .expect("in range");
            }
            flow.step(0.01).expect("in range");
            flow.visit(&mut |_, _, value| bits.push(value.to_bits()));
        }
        bits
    };
    assert_eq!(run(false), run(true));
}

#[test]
fn a_medium_that_is_none_is_refused_by_name_and_changes_nothing() {
    let mut flow = Flow::new(&heavy(4, Vessel::Box)).expect("a flow");
    let medium = |density_kg_m3, viscosity_m2_s| Medium { density_kg_m3, viscosity_m2_s };
    for (bad, what) in [
        (medium(f64::NAN, 0.0), "density_kg_m3"),
        (medium(0.0, 0.0), "density_kg_m3"),
        (medium(1e7, 0.0), "density_kg_m3"),
        (medium(1.0, -1.0), "viscosity_m2_s"),
        (medium(1.0, f64::INFINITY), "viscosity_m2_s"),
    ] {
        let here = |p: DVec3| if p.x > 0.7 { bad } else { medium(900.0, 1.0) };
        assert_eq!(flow.set_medium(&here).expect_err("bad").what, what);
    }
    assert!(flow.step(0.1).expect("in range").asleep);
    let nowhere = Setup { gravity_m_s2: Vec3::NAN, ..heavy(4, Vessel::Box) };
    let refused = Flow::new(&nowhere).err().expect("no gravity").to_string();
    assert!(refused.contains("gravity_m_s2"), "{refused}");
}
