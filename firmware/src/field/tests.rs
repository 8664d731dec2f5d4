use cauldron_protocol::{
    field::{PatchHead, quantum_for},
    units::{Metres, NewtonSecondsPerMetre},
};

use super::*;

const REST: RestMedium = RestMedium {
    linear_drag: NewtonSecondsPerMetre(3.0),
    quadratic_drag: cauldron_protocol::units::NewtonSeconds2PerMetre2(0.0),
};
const ALL: Channels = Channel::FLOW.and(Channel::DRAG);

/// A field whose flow is linear in space, sent slab by slab.
fn send(field: &mut Field, epoch: u32, life: [u32; 2], flow_x: impl Fn(Vec3) -> f32) -> FieldHead {
    let quantum = quantum_for(2.0);
    let patch = PatchHead {
        nodes: [3, 2],
        origin: [Metres(0.0); 2],
        spacing: Metres(0.1),
        quanta: [quantum; 4],
    };
    let head = FieldHead {
        epoch,
        valid_from: Ticks(life[0]),
        valid_until: Ticks(life[1]),
        channels: ALL,
        nodes: [5, 4, 6],
        origin: [Metres(-0.02), Metres(0.0), Metres(0.01)],
        spacing: Metres(0.01),
        quanta: [quantum; 8],
        patch: Some(patch),
    };
    let mut samples = Vec::new();
    for channel in 0..5 {
        for node in 0..head.node_count() {
            let (i, j, k) = (node % 5, node / 5 % 4, node / 20);
            let at = Vec3::new(-0.02 + 0.01 * i as f32, 0.01 * j as f32, 0.01 + 0.01 * k as f32);
            let value = match channel {
                0 => flow_x(at),
                3 => 1.0,
                _ => 0.0,
            };
            samples.push((value / quantum) as i16);
        }
    }
    for value in [0.5, 0.0, 1.5, 0.25] {
        samples.extend([(value / quantum) as i16; 6]);
    }
    let bytes: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
    let mut torn = 0;
    field.begin(Ticks(life[0]), head, &mut torn).unwrap();
    for (index, data) in bytes.chunks(SlabHead::MAX_DATA).enumerate() {
        field.store(Ticks(life[0]), SlabHead { epoch, index: index as u16 }, data);
    }
    head
}

fn linear(at: Vec3) -> f32 {
    0.3 + 5.0 * at.x - 3.0 * at.y + 2.0 * at.z
}

#[test]
fn a_linear_flow_comes_back_exactly_to_the_quantum() {
    let mut field = Field::default();
    send(&mut field, 1, [0, 10], linear);
    field.advance(Ticks(0));
    for at in [Vec3::new(0.0, 0.01, 0.03), Vec3::new(-0.0137, 0.0271, 0.0501)] {
        let medium = field.medium(Ticks(10), at, ALL, &REST);
        assert!((medium.flow_m_s.x - linear(at)).abs() < 2.0 * quantum_for(2.0), "{medium:?}");
        assert!((medium.linear_drag_n_s_per_m - 1.0).abs() < 1e-3);
        let surface = medium.surface.unwrap();
        assert_eq!(
            [surface.height_m, surface.stiffness_n_per_m, surface.break_force_n],
            [0.5, 1.5, 0.25]
        );
    }
}

#[test]
fn channels_nobody_wants_are_not_sampled() {
    let mut field = Field::default();
    send(&mut field, 1, [0, 10], linear);
    field.advance(Ticks(0));
    let medium = field.medium(Ticks(10), Vec3::new(0.0, 0.01, 0.03), Channel::DRAG, &REST);
    assert_eq!(medium.flow_m_s, Vec3::ZERO);
    assert!(medium.linear_drag_n_s_per_m > 0.9);
}

#[test]
fn outside_of_the_window_the_medium_fades_to_rest_over_one_spacing() {
    let mut field = Field::default();
    send(&mut field, 1, [0, 10], |_| 0.4);
    field.advance(Ticks(0));
    let at = |x| field.medium(Ticks(10), Vec3::new(x, 0.01, 0.03), ALL, &REST);
    assert!((at(0.02).flow_m_s.x - 0.4).abs() < 1e-3);
    assert!((at(0.025).flow_m_s.x - 0.2).abs() < 1e-3);
    assert!((at(0.025).linear_drag_n_s_per_m - 2.0).abs() < 1e-3);
    assert_eq!(at(0.2), Medium { surface: at(0.2).surface, ..Medium::at_rest(&REST) });
}

#[test]
fn one_field_is_ramped_to_the_next_without_a_jump() {
    let mut field = Field::default();
    let at = Vec3::new(0.0, 0.01, 0.03);
    send(&mut field, 1, [0, 16], |_| 0.2);
    field.advance(Ticks(10));
    send(&mut field, 2, [16, 32], |_| 1.0);
    let mut last = 0.2;
    for tick in 10..=32 {
        field.advance(Ticks(tick));
        let flow = field.medium(Ticks(tick), at, ALL, &REST).flow_m_s.x;
        assert!(flow - last < 0.8 / 16.0 + 1e-3, "{tick}: {last} to {flow}");
        last = flow;
        assert_eq!(field.epoch(), if tick < 16 { 1 } else { 2 });
    }
    assert!((last - 1.0).abs() < 1e-3);
}

#[test]
fn a_stale_field_is_held_faded_and_comes_back() {
    let mut field = Field::default();
    let at = Vec3::new(0.0, 0.01, 0.03);
    send(&mut field, 1, [0, 10], |_| 0.4);
    let flow_at = |field: &mut Field, tick| {
        let fresh = field.advance(Ticks(tick));
        (fresh, field.medium(Ticks(tick), at, ALL, &REST))
    };
    flow_at(&mut field, 0);
    assert_eq!(flow_at(&mut field, 40).0, 1.0);
    for tick in 41..70 {
        flow_at(&mut field, tick);
    }
    let (fresh, medium) = flow_at(&mut field, 70);
    assert_eq!((fresh, medium.flow_m_s.x), (0.0, 0.0));
    assert_eq!(medium.surface.map(|s| s.stiffness_n_per_m), Some(0.0));
    field.keep(Ticks(70), Keep { epoch: 1, valid_until: Ticks(500) }).unwrap();
    let (fresh, _) = flow_at(&mut field, 71);
    assert!(fresh > 0.0 && fresh < 0.02, "a ramp, not a step: {fresh}");
    for tick in 72..180 {
        flow_at(&mut field, tick);
    }
    assert!((flow_at(&mut field, 180).1.flow_m_s.x - 0.4).abs() < 1e-3);
}

/// A weight is no medium at rest: nobody carries it when nobody says that it is there.
#[test]
fn the_bias_of_a_stale_field_fades_with_it() {
    let heavy = Medium { bias_n: Vec3::new(0.0, -2.0, 0.0), ..Medium::default() };
    assert_eq!(heavy.faded_to(&REST, 0.25).bias_n, Vec3::new(0.0, -0.5, 0.0));
    assert_eq!(heavy.faded_to(&REST, 0.0), Medium::at_rest(&REST));
}

#[test]
fn keep_prolongs_the_field_it_names_and_no_other() {
    let mut field = Field::default();
    send(&mut field, 7, [0, 10], |_| 0.4);
    field.advance(Ticks(0));
    assert_eq!(
        field.keep(Ticks(0), Keep { epoch: 6, valid_until: Ticks(90) }),
        Err(Refusal::WrongEpoch)
    );
    assert_eq!(field.advance(Ticks(69)), 1.0 - 29.0 / 30.0);
    let mut field = Field::default();
    send(&mut field, 7, [0, 10], |_| 0.4);
    field.keep(Ticks(0), Keep { epoch: 7, valid_until: Ticks(90) }).unwrap();
    assert_eq!(field.advance(Ticks(69)), 1.0);
}

#[test]
fn half_a_field_never_acts() {
    let mut field = Field::default();
    let head = send(&mut field, 1, [0, 10], |_| 0.4);
    field.advance(Ticks(0));
    let mut torn = 0;
    field.begin(Ticks(0), FieldHead { epoch: 2, ..head }, &mut torn).unwrap();
    field.store(Ticks(0), SlabHead { epoch: 2, index: 0 }, &[0; 512]);
    field.store(Ticks(0), SlabHead { epoch: 2, index: 0 }, &[0; 512]);
    field.store(Ticks(0), SlabHead { epoch: 3, index: 1 }, &[0; 512]);
    field.store(Ticks(0), SlabHead { epoch: 2, index: 1 }, &[0; 3]);
    field.advance(Ticks(20));
    assert_eq!((field.epoch(), torn), (1, 0));
    field.begin(Ticks(0), FieldHead { epoch: 3, ..head }, &mut torn).unwrap();
    assert_eq!(torn, 1);
    let unsound = FieldHead { epoch: 4, nodes: [9; 3], ..head };
    assert_eq!(field.begin(Ticks(0), unsound, &mut torn), Err(Refusal::BadField));
}

#[test]
fn fields_from_a_host_whose_clock_runs_ahead_act_all_the_same() {
    let mut field = Field::default();
    for epoch in 1..=5 {
        let from = 1000 + 10 * epoch;
        send(&mut field, epoch, [from, from + 10], |_| 0.1 * epoch as f32);
        field.advance(Ticks(10 * epoch));
    }
    assert_eq!(field.epoch(), 4, "the last but one acts, the last waits");
}

#[test]
fn nothing_is_promised_for_longer_than_a_second_and_time_may_wrap() {
    let mut field = Field::default();
    let head = send(&mut field, 1, [0, 10], |_| 0.4);
    let forever = FieldHead { epoch: 2, valid_until: Ticks(1001), ..head };
    assert_eq!(field.begin(Ticks(0), forever, &mut 0), Err(Refusal::BadField));
    let keep = Keep { epoch: 1, valid_until: Ticks(i32::MAX as u32) };
    assert_eq!(field.keep(Ticks(0), keep), Err(Refusal::BadValue));
    for now in [1 << 31, (1 << 31) + 20, u32::MAX - 3, 3] {
        assert_eq!(Field::default().advance(Ticks(now)), 0.0);
        field.advance(Ticks(now));
    }
}
