//! Something knocks on the water with a felt newton: its ripple reaches a hand that rests on the
//! surface elsewhere, strong enough to be felt, and when the dispersion relation says so.

use cauldron_fluid::scenes::{Act, Poke, Scene};
use cauldron_protocol::state::Flags;
use glam::{DVec2, Vec3};
use std::f64::consts::PI;

use super::scene;
use crate::{
    scenario::{Scenario, must},
    trace::{Trace, force_n},
};

/// Where the hand rests, and where it knocks.
const HAND_M: Vec3 = Vec3::new(0.055, 0.0, 0.0);
const KNOCK_M: Vec3 = Vec3::new(-0.055, 0.0, 0.0);
const KNOCK_RADIUS_M: f32 = 0.03;
const KNOCK_S: [f32; 2] = [2.5, 2.6];
/// Force that a hand can tell from none (Lee, Hannaford 2003).
const THRESHOLD_N: f64 = 0.0208;
/// Ticks from the knock on in which the ripple comes, and goes by.
const WINDOW: usize = 800;

fn pond() -> Scene {
    let acts = vec![
        Act::Rest { seconds: 0.5 },
        Act::Reach { to_m: HAND_M - 0.004 * Vec3::Y, seconds: 1.0 },
        Act::Rest { seconds: 2.0 },
    ];
    let mut scene = scene("pond", HAND_M + 0.04 * Vec3::Y, acts);
    scene.story.pokes = vec![Poke {
        at_m: KNOCK_M,
        radius_m: KNOCK_RADIUS_M,
        force_n: -1.0 / scene.feel.felt_scale,
        from_s: KNOCK_S[0],
        to_s: KNOCK_S[1],
    }];
    scene
}

pub const SCENARIO: Scenario = Scenario {
    name: "ripple",
    about: "a knock of one newton on the water is felt by a hand that rests on it elsewhere",
    scene: pond,
    seconds: 3.5,
    events: &[],
    verdict: |trace| {
        let knock = (f64::from(KNOCK_S[0]) * 1e3) as usize;
        must(trace.has(knock - 10, Flags::ON_SURFACE), || "the hand does not touch".into())?;
        let felt_n = ripple(trace, knock);
        let strongest_n = felt_n.iter().fold(0.0, |most: f64, n| most.max(n.abs()));
        must(strongest_n >= THRESHOLD_N, || format!("a ripple of {strongest_n} N cannot be felt"))?;
        let height_m = heights();
        let strongest = |a: &usize, b: &usize| height_m[*a].abs().total_cmp(&height_m[*b].abs());
        let due = (0..height_m.len()).max_by(strongest).unwrap_or(0);
        let (late, likeness) = lag(&height_m, &felt_n);
        must(likeness >= 0.7, || format!("{likeness} alike: what comes is not the ripple"))?;
        must(late.abs() <= 0.1 * due as f64, || {
            format!("{late} ms late: the dispersion relation says {due} ms")
        })
    },
};

/// Force on the hand from the knock on, tick by tick, over that at rest: means over 20 ticks, in
/// which a tremor hides.
fn ripple(trace: &Trace, knock: usize) -> Vec<f64> {
    let mean_n = |from: usize| -> f64 {
        let states = &trace.states[from - 10..from + 10];
        states.iter().map(|s| force_n(s).y).sum::<f64>() / states.len() as f64
    };
    let rest_n = mean_n(knock - 20);
    (knock..knock + WINDOW).map(|tick| mean_n(tick) - rest_n).collect()
}

/// How many ticks `felt` comes after `due`, by their correlation, and how much they are alike then.
fn lag(due: &[f64], felt: &[f64]) -> (f64, f64) {
    let alike = |late: i32| {
        let [mut both, mut a, mut b] = [1e-30; 3];
        for (tick, due) in due.iter().enumerate() {
            let Some(felt) = usize::try_from(tick as i32 + late).ok().and_then(|t| felt.get(t))
            else {
                continue;
            };
            (both, a, b) = (both + due * felt, a + due * due, b + felt * felt);
        }
        both / (a * b).sqrt()
    };
    let best = (-200..=200).max_by(|a, b| alike(*a).total_cmp(&alike(*b))).unwrap_or(0);
    (f64::from(best), alike(best))
}

/// Height of the water under the hand from the knock on, tick by tick, as if nobody touched it: the
/// sum of the standing waves of the tank, each as omega^2 = (g k + sigma k^3 / rho) tanh kh says.
fn heights() -> Vec<f64> {
    let scene = pond();
    let side_m = f64::from(scene.grid.extent_m().x);
    let depth_m = f64::from(scene.grid.extent_m().y);
    let tension = scene.surface.map_or(0.0, |s| f64::from(s.tension_n_per_m));
    let corner = scene.grid.origin_in_world_m;
    let place = |at: Vec3| DVec2::new(f64::from(at.x - corner.x), f64::from(at.z - corner.z));
    let (hand, knock) = (place(HAND_M), place(KNOCK_M));
    let lasts_s = f64::from(KNOCK_S[1] - KNOCK_S[0]);
    let mut waves = Vec::new();
    for (m, n) in (0..40).flat_map(|m| (0..40).map(move |n| (m, n))).skip(1) {
        let k = DVec2::new(f64::from(m), f64::from(n)) * PI / side_m;
        let shape = |at: DVec2| (k.x * at.x).cos() * (k.y * at.y).cos();
        let size = k.length();
        let stiff = 9.81 + tension / 1000.0 * size * size;
        let omega = (stiff * size * (size * depth_m).tanh()).sqrt();
        let norm = if m == 0 || n == 0 { 2.0 } else { 4.0 };
        let pushed = norm * shape(knock) * disc(size * f64::from(KNOCK_RADIUS_M));
        waves.push((omega, pushed * shape(hand) / stiff));
    }
    let height = |t: f64| -> f64 {
        // A push that is held and then let go.
        let held = |omega: f64, t: f64| if t > 0.0 { 1.0 - (omega * t).cos() } else { 0.0 };
        waves.iter().map(|(omega, a)| -a * (held(*omega, t) - held(*omega, t - lasts_s))).sum()
    };
    (0..WINDOW).map(|tick| height(1e-3 * tick as f64)).collect()
}

/// The mean of cos(k.x) over a disc on which the push falls as 1 - r^2/R^2 from its middle:
/// 8 J2(kR) / (kR)^2, by its series.
fn disc(kr: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 0.0);
    for n in 1..60 {
        sum += term;
        term *= -0.25 * kr * kr / (f64::from(n) * f64::from(n + 2));
    }
    sum
}
