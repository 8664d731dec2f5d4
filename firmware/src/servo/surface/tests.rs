use super::*;

const STIFFNESS_N_PER_M: f32 = 400.0;
const BREAK_N: f32 = 1.0;
/// Reached 3 mm above the surface.
const PULL_N: f32 = 1.2;
const TICK_S: f32 = 1e-3;

fn over(height_m: f32) -> Medium {
    let surface = Surface {
        height_m,
        velocity_m_s: 0.0,
        stiffness_n_per_m: STIFFNESS_N_PER_M,
        break_force_n: BREAK_N,
    };
    Medium { surface: Some(surface), linear_drag_n_s_per_m: 1.0, ..Medium::default() }
}

fn at(y: f32) -> Vec3 {
    Vec3::new(0.0, y, 0.0)
}

/// A contact that held still at each of some heights over a surface at 10 mm.
fn visit(surface: &mut SurfaceContact, heights_m: &[f32]) -> Contact {
    let mut contact = Contact::Dry;
    for y in heights_m {
        contact = surface.update(true, PULL_N, at(*y), Vec3::ZERO, &over(0.01));
    }
    contact
}

#[test]
fn gives_pops_clings_and_lets_go() {
    let mut surface = SurfaceContact::default();
    for (y, contact) in [
        (0.02, Contact::Dry),
        (0.008, Contact::OnSurface),
        (0.0101, Contact::Dry),
        (0.008, Contact::OnSurface),
        (0.007, Contact::Wet),
        (0.0099, Contact::Wet),
        (0.0101, Contact::Clinging),
        (0.0099, Contact::Clinging),
        (0.0094, Contact::Wet),
        (0.0129, Contact::Clinging),
        (0.0131, Contact::Dry),
        (0.0101, Contact::Dry),
        (0.0095, Contact::OnSurface),
    ] {
        assert_eq!(visit(&mut surface, &[y]), contact, "at {y}");
    }
}

#[test]
fn pushes_from_above_and_pulls_from_below() {
    let force_y_n = |contact, y: f32, v: f32| force_n(contact, PULL_N, at(y), at(v), &over(0.01)).y;
    let push = |v| force_y_n(Contact::OnSurface, 0.008, v);
    assert!((push(0.0) - 0.8).abs() < 1e-5);
    assert!((push(-0.01) - 0.84).abs() < 1e-5, "sinking costs more");
    assert_eq!(push(1.0), 0.0, "it never pulls");
    let pull = |v| force_y_n(Contact::Clinging, 0.012, v);
    assert!((pull(0.0) + 0.8).abs() < 1e-5);
    assert!((pull(0.01) + 0.84).abs() < 1e-5, "rising costs more");
    assert_eq!(pull(-1.0), 0.0, "it never pushes");
    assert_eq!(pull(1.0), -PULL_N, "nor pulls harder than it can");
    assert_eq!(force_y_n(Contact::Wet, 0.009, 0.0), 0.0);
}

/// Tremor of 0.1 mm around each threshold: through once, out once.
#[test]
fn tremor_at_a_threshold_does_not_chatter() {
    for (before, threshold_m) in [
        (&[0.02, 0.008][..], 0.0075),         // the break force
        (&[0.02, 0.007][..], 0.0100),         // the level, from below
        (&[0.02, 0.007, 0.0101][..], 0.0095), // wet again
        (&[0.02, 0.007, 0.0101][..], 0.0130), // the pull force
    ] {
        let mut surface = SurfaceContact::default();
        let mut last = visit(&mut surface, before);
        let mut changes = 0;
        for tick in 0..1000 {
            let y = threshold_m + if tick % 100 < 50 { 1e-4 } else { -1e-4 };
            let contact = visit(&mut surface, &[y]);
            changes += u32::from(contact != last);
            last = contact;
        }
        assert!(changes <= 1, "at {threshold_m}: {changes} changes");
    }
}

/// A pull force that is reached within the hysteresis still holds to its end.
#[test]
fn a_weak_neck_pulls_weakly_and_still_keeps_the_ripple_out() {
    let mut surface = SurfaceContact::default();
    let weak_n = 0.1;
    let mut go = |y| surface.update(true, weak_n, at(y), Vec3::ZERO, &over(0.01));
    assert_eq!([0.02, 0.007, 0.0119].map(&mut go)[2], Contact::Clinging);
    assert_eq!(force_n(Contact::Clinging, weak_n, at(0.0119), Vec3::ZERO, &over(0.01)).y, -weak_n);
    assert_eq!(go(0.0121), Contact::Dry);
}

#[test]
fn a_surface_that_is_not_felt_holds_nothing() {
    let mut surface = SurfaceContact::default();
    let mut go = |y| surface.update(false, PULL_N, at(y), Vec3::ZERO, &over(0.01));
    assert_eq!(go(0.0099), Contact::Wet);
    assert_eq!(go(0.0121), Contact::Dry, "and has no neck");
    let faded = over(0.01).surface.map(|s| Surface { stiffness_n_per_m: 0.0, ..s });
    let stale = Medium { surface: faded, ..Medium::default() };
    let mut surface = SurfaceContact::default();
    let mut go = |y| surface.update(true, PULL_N, at(y), Vec3::ZERO, &stale);
    assert_eq!(go(0.0099), Contact::Wet);
    assert_eq!(go(0.0101), Contact::Clinging);
    assert_eq!(force_n(Contact::Clinging, PULL_N, at(0.0119), Vec3::ZERO, &stale), Vec3::ZERO);
    assert_eq!(go(0.0121), Contact::Dry);
}

#[test]
fn without_a_surface_the_medium_is_everywhere_or_nowhere() {
    let mut surface = SurfaceContact::default();
    let everywhere = Medium { linear_drag_n_s_per_m: 1.0, ..Medium::default() };
    let mut go = |medium| surface.update(true, PULL_N, at(1.0), Vec3::ZERO, medium);
    assert_eq!(go(&everywhere), Contact::Wet);
    assert_eq!(go(&Medium::default()), Contact::Dry);
}

/// What ten seconds of a random hand came to.
struct Wander {
    /// The most that the hand was given beyond what the surface's own motion brought, since spring
    /// or neck last held nothing: sums of F_k (y_k+1 - y_k) and, without the damper's part, of
    /// F_k (H_k+1 - H_k), with what a tick's holding of the force adds where the surface moves.
    worst_j: f64,
    /// Times through, and times out.
    pops: [u32; 2],
}

/// xorshift64* (Marsaglia 2003), from 0 to 1.
fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A hand that starts and ends in the air and goes in and out at random through a surface that
/// swells by `wave_m`.
fn wander(seed: u64, wave_m: f64) -> Wander {
    use core::f64::consts::TAU;
    let mut draw = draws(seed);
    let tones: Vec<[f64; 3]> =
        (0..5).map(|_| [0.3 + 4.0 * draw(), 4e-3 * draw(), TAU * draw()]).collect();
    let swell = [1.0 + 5.0 * draw(), wave_m, TAU * draw()];
    let tone = |[hertz, size, phase]: [f64; 3], t: f64| size * (TAU * hertz * t + phase).sin();
    let lifted = |t: f64| 0.04 * (1.0 - (t / 0.5).min((10.0 - t) / 0.5).clamp(0.0, 1.0));
    let hand = |tick: i32| {
        let t = 1e-3 * f64::from(tick);
        (tones.iter().map(|w| tone(*w, t)).sum::<f64>() + lifted(t)) as f32
    };
    let level = |tick: i32| tone(swell, 1e-3 * f64::from(tick)) as f32;
    let mut surface = SurfaceContact::default();
    let mut sum = Wander { worst_j: 0.0, pops: [0; 2] };
    let (mut beyond_j, mut last) = (0.0, Contact::Dry);
    for tick in 0..10_000 {
        let (y, medium) = (at(hand(tick)), over(level(tick)));
        let velocity = at((hand(tick) - hand(tick - 1)) / TICK_S);
        let contact = surface.update(true, PULL_N, y, velocity, &medium);
        if matches!(contact, Contact::Dry | Contact::Wet) {
            beyond_j = 0.0;
        }
        let n = |velocity| f64::from(force_n(contact, PULL_N, y, velocity, &medium).y);
        let risen_m = f64::from(level(tick + 1) - level(tick));
        let held_j = 0.5 * f64::from(STIFFNESS_N_PER_M) * risen_m * risen_m;
        let brought_j = n(Vec3::ZERO) * risen_m + if n(velocity) == 0.0 { 0.0 } else { held_j };
        beyond_j += n(velocity) * f64::from(hand(tick + 1) - hand(tick)) - brought_j;
        sum.worst_j = sum.worst_j.max(beyond_j);
        sum.pops[0] += u32::from(contact == Contact::Wet && last == Contact::OnSurface);
        sum.pops[1] += u32::from(contact == Contact::Dry && last == Contact::Clinging);
        last = contact;
    }
    sum
}

/// However the hand goes in and out, at no time has spring or neck given more than was put in.
#[test]
fn a_still_surface_gives_no_energy() {
    let mut pops = [0; 2];
    for seed in 1..40 {
        let found = wander(seed, 0.0);
        assert!(found.worst_j <= 1e-9, "seed {seed}: {} J", found.worst_j);
        pops = [0, 1].map(|i| pops[i] + found.pops[i]);
    }
    assert!(pops.iter().all(|pops| *pops > 40), "{pops:?}");
}

/// But for the depth that a tick finds the probe at when it first touches.
#[test]
fn a_moving_surface_gives_no_more_than_its_own_motion_brings() {
    for seed in 1..40 {
        let found = wander(seed, 4e-3);
        assert!(found.worst_j <= 2e-6, "seed {seed}: {} J", found.worst_j);
    }
}
