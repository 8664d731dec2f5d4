//! The wire as bytes: golden frames, and a decoder that nothing throws off.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use cauldron_protocol::{
    Down, Drops, Kind, State, States, Up, Verdict, WorldFromDevice,
    field::{Channel, FieldHead, SlabHead},
    frame::{Decoder, MAX_BODY, MAX_FRAME, encode, encode_message},
    message::Keep,
    schema_hash,
    units::{Metres, Ticks},
};
use proptest::prelude::*;

fn frame(kind: Kind, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    encode(kind, sequence, &mut out, |room| {
        room.get_mut(..body.len())?.copy_from_slice(body);
        Some(body.len())
    })
    .unwrap()
    .to_vec()
}

fn decode_all(decoder: &mut Decoder, mut bytes: &[u8]) -> Vec<(Kind, u16, Vec<u8>)> {
    let mut frames = Vec::new();
    while let Some(f) = decoder.feed(&mut bytes) {
        frames.push((f.kind, f.sequence, f.body.to_vec()));
    }
    frames
}

fn message_bytes(message: &Down) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    encode_message(Kind::Down, 0x0102, message, &mut out).unwrap().to_vec()
}

/// Bytes that must not change while `PROTOCOL_VERSION` stays: the CRCs were computed by another
/// implementation (zlib's).
#[test]
fn golden_bytes() {
    let keep = Down::Keep(Keep { epoch: 300, valid_until: Ticks(70_000) });
    assert_eq!(message_bytes(&Down::Arm), [10, 1, 1, 2, 1, 4, 254, 152, 12, 94, 0]);
    assert_eq!(
        message_bytes(&keep),
        [15, 1, 1, 2, 1, 7, 172, 2, 240, 162, 4, 196, 248, 34, 211, 0]
    );
}

#[test]
fn the_schema_hash_names_this_layout() {
    assert_eq!(
        schema_hash(),
        0x5555_1cfd_323b_ecb3,
        "{:#018x}: a changed message needs a new golden hash",
        schema_hash()
    );
}

#[test]
fn four_states_fit_into_a_frame() {
    let mut states = States::new();
    let worst = State {
        tick: Ticks(u32::MAX),
        field_epoch: u32::MAX,
        impulse_to_fluid: [cauldron_protocol::units::PiconewtonSeconds(i64::MIN); 3],
        drops: Drops {
            corrupt: u16::MAX,
            truncated: u16::MAX,
            oversized: u16::MAX,
            repeated: u16::MAX,
            version: u16::MAX,
            unknown: u16::MAX,
            torn: u16::MAX,
        },
        ..State::default()
    };
    while states.push(worst).is_ok() {}
    let mut out = [0; MAX_FRAME];
    assert!(encode_message(Kind::States, 1, &states, &mut out).is_ok());
}

#[test]
fn messages_come_back_as_they_went() {
    let head = FieldHead {
        epoch: 3,
        valid_from: Ticks(10),
        valid_until: Ticks(26),
        channels: Channel::FLOW.and(Channel::DRAG),
        nodes: [8; 3],
        origin: [Metres(-0.01), Metres(0.0), Metres(0.02)],
        spacing: Metres(0.005),
        quanta: [1e-4; 8],
        patch: None,
    };
    for message in [
        Down::Hello,
        Down::Field(head),
        Down::Ping { host_us: 77 },
        Down::Configure(cauldron_protocol::message::Config {
            world_from_device: WorldFromDevice::default(),
            ceilings: cauldron_protocol::message::Ceilings {
                force: cauldron_protocol::units::Newtons(3.3),
                slew: cauldron_protocol::units::NewtonsPerSecond(1e3),
            },
        }),
    ] {
        let frames = decode_all(&mut Decoder::default(), &message_bytes(&message));
        assert_eq!(postcard::from_bytes::<Down>(&frames[0].2).unwrap(), message);
    }
    let ack = Up::Ack { sequence: 9, verdict: Verdict::Accepted };
    let bytes = postcard::to_vec::<_, 16>(&ack);
    assert!(bytes.is_ok_and(|b| postcard::from_bytes::<Up>(&b) == Ok(ack)));
}

#[test]
fn every_way_to_be_wrong_is_counted_by_its_name() {
    let good = frame(Kind::Down, 1, &[0]);
    let mut other_version = [0; 64];
    let plain = [9, 1, 2, 0, 0xff];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&plain);
    let n = cobs::encode(&[&plain[..], &crc.to_le_bytes()].concat(), &mut other_version);

    let mut decoder = Decoder::default();
    let mut stream = vec![2, 5, 0]; // truncated: one byte of plain text
    stream.extend([9, 5, 0]); // corrupt: the stuffing points past the end
    stream.extend(vec![1; MAX_FRAME + 1]); // oversized
    stream.push(0);
    stream.extend(&other_version[..=n]);
    stream.extend(&good);
    stream.extend(&good); // repeated
    let mut flipped = frame(Kind::Down, 2, &[1, 2, 3]);
    flipped[5] ^= 0x40; // corrupt: the CRC tells
    stream.extend(flipped);
    stream.extend(frame(Kind::Down, 4, &[7])); // 2 was corrupt and 3 was never sent
    let frames = decode_all(&mut decoder, &stream);
    assert_eq!(frames.iter().map(|f| f.1).collect::<Vec<_>>(), [1, 4]);
    let want = Drops {
        corrupt: 2,
        truncated: 1,
        oversized: 1,
        repeated: 1,
        version: 1,
        ..Drops::default()
    };
    assert_eq!(decoder.drops, want);
    assert_eq!(decoder.lost, 2);
}

#[test]
fn a_body_that_is_too_long_is_refused() {
    let mut out = [0; MAX_FRAME];
    assert!(encode(Kind::FieldSlab, 0, &mut out, |_| Some(MAX_BODY + 1)).is_err());
    assert!(
        encode(Kind::FieldSlab, 0, &mut out, |room| {
            SlabHead { epoch: 1, index: 0 }.join(&[1; SlabHead::MAX_DATA], room)
        })
        .is_ok()
    );
}

proptest! {
    #[test]
    fn any_body_comes_back_whatever_stands_before_it(
        junk in proptest::collection::vec(any::<u8>(), 0..1500),
        body in proptest::collection::vec(any::<u8>(), 0..MAX_BODY),
        sequence: u16,
    ) {
        let mut decoder = Decoder::default();
        decode_all(&mut decoder, &junk);
        decode_all(&mut decoder, &[0]);
        let frames = decode_all(&mut decoder, &frame(Kind::Up, sequence, &body));
        prop_assert_eq!(frames, vec![(Kind::Up, sequence, body)]);
    }

    #[test]
    fn any_single_bit_flip_drops_the_frame_or_leaves_it_alone(
        body in proptest::collection::vec(any::<u8>(), 1..64),
        at: prop::sample::Index,
        bit in 0..8u8,
    ) {
        let mut bytes = frame(Kind::Up, 1, &body);
        let place = at.index(bytes.len());
        bytes[place] ^= 1 << bit;
        bytes.push(0);
        for (kind, sequence, got) in decode_all(&mut Decoder::default(), &bytes) {
            prop_assert_eq!((kind, sequence, &got), (Kind::Up, 1, &body));
        }
    }
}
