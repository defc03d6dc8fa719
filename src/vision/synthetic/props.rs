//! Everything that stands on the pitch at one moment: people, the ball, goals with nets, corner
//! flags.

use super::body::{Kits, body, bystander};
use super::courts::boards_m;
use super::light::{Light, hex};
use super::options::StadiumOptions;
use super::play::{Play, Side};
use super::solid::{Sheet, Stick};
use super::texture::{hash, sub_seed, unit};
use touchline_core::field::{Curve, FieldModel};
use touchline_core::geometry::Vec3;

/// Something that stands in the scene.
#[derive(Clone, Debug)]
pub(super) struct Prop {
    pub sticks: Vec<Stick>,
    pub sheets: Vec<Sheet>,
    /// Set for whoever moves: a player, an official or the ball.
    pub mover: Option<Mover>,
    /// Whether it throws a shadow worth drawing.
    pub throws_shadow: bool,
}

/// What moves on the pitch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// A person.
    Person(Side),
    /// The ball.
    Ball,
}

impl Prop {
    /// A sphere around it: centre and radius, m.
    pub fn bounds(&self) -> (Vec3, f64) {
        // The sphere around the box of all parts, which is enough: it only limits which pixels are
        // tried.
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = -low;
        let mut take = |point: Vec3, radius: f64| {
            low = low.inf(&(point - Vec3::repeat(radius)));
            high = high.sup(&(point + Vec3::repeat(radius)));
        };
        for stick in &self.sticks {
            take(stick.from, stick.radius_from_m);
            take(stick.to, stick.radius_to_m);
        }
        for sheet in &self.sheets {
            for (across, up) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let breadth = across * sheet.breadth_m[0].max(sheet.breadth_m[1]);
                take(
                    sheet.corner + sheet.across * breadth + sheet.up * (up * sheet.height_m),
                    0.0,
                );
            }
        }
        (0.5 * (low + high), 0.5 * (high - low).norm())
    }
}

/// The people and the ball at a time.
pub(super) fn movers(play: &Play, kits: &Kits, field: &FieldModel, time_s: f64) -> Vec<Prop> {
    let mut props: Vec<Prop> = play
        .people(time_s)
        .iter()
        .map(|person| Prop {
            sticks: body(person, kits, field.ground_z(person.place[1])),
            sheets: Vec::new(),
            mover: Some(Mover::Person(person.side)),
            throws_shadow: true,
        })
        .collect();
    let ball = play.ball(time_s);
    let centre = field.world_from_nominal(ball);
    props.push(Prop {
        sticks: vec![Stick::ball(centre, 0.11, hex(0xF4_F4F2))],
        sheets: Vec::new(),
        mover: Some(Mover::Ball),
        throws_shadow: true,
    });
    props
}

/// What stands still: goals and nets, the boards of a rink, flags, and people behind the boards.
pub(super) fn fixtures(options: &StadiumOptions) -> Vec<Prop> {
    let field = &options.field;
    let mut props = goals(field);
    let net_m = options.scene.court().map_or(0.0, |court| court.net_m);
    props.extend(raised_props(field, net_m));
    props.extend(flags(field));
    props.extend(bystanders(options));
    props
}

/// What stands still and moves not.
fn fixture(sticks: Vec<Stick>, sheets: Vec<Sheet>, throws_shadow: bool) -> Prop {
    Prop {
        sticks,
        sheets,
        mover: None,
        throws_shadow,
    }
}

/// The length of the straight pieces of curves, and of long boards, m.
const PIECE_M: f64 = 2.5;

/// Rings, nets and the boards of a rink: the raised lines that are no posts.
fn raised_props(field: &FieldModel, net_m: f64) -> Vec<Prop> {
    let mut props = Vec::new();
    for line in field.lines.iter().filter(|line| !line.painted) {
        let name = line.id.as_str();
        // Templates name them alike in all sports.
        let is_rink = name.starts_with("boards_") && name.ends_with("_top");
        let is_net = name.starts_with("net_top");
        let is_arc = matches!(line.curve, Curve::Arc { .. });
        if !is_rink && !is_net && !is_arc {
            continue;
        }
        // Straight pieces, so that one that lies partly behind the camera loses only a piece; a
        // ring has a dozen.
        let ring = if line.curve.is_closed() { 12.0 } else { 1.0 };
        let count = if is_net {
            1.0
        } else {
            (line.curve.length_m() / PIECE_M).ceil().max(ring)
        };
        for piece in 0..count as usize {
            let ends = [piece, piece + 1].map(|end| line.curve.point_at(end as f64 / count));
            let [from, to] = ends.map(|end| field.world_from_nominal(end));
            if from.z <= 0.0 {
                continue;
            }
            // A net hangs from its upper edge, boards stand on the ice.
            let height_m = if is_rink {
                from.z
            } else {
                net_m.min(from.z.min(to.z))
            };
            let cloth = Sheet {
                corner: from - Vec3::z() * height_m,
                across: (to - from).normalize(),
                up: Vec3::z(),
                breadth_m: [(to - from).norm(); 2],
                height_m,
                mesh_m: is_net.then_some([0.004, 0.06]),
                albedo: if is_rink {
                    hex(0xE6_E9EC)
                } else {
                    hex(0x1C_1E20)
                },
            };
            // A ring is a rim alone.
            let sheets = if is_rink || is_net {
                vec![cloth]
            } else {
                Vec::new()
            };
            let colour = if is_arc && !is_rink {
                hex(0xD8_5A20)
            } else {
                hex(0xF2_F3F2)
            };
            let rail = Stick::new(from, to, (0.5 * line.width_m).max(0.02), colour);
            props.push(fixture(vec![rail], sheets, false));
        }
    }
    props
}

/// Posts and crossbars wherever the field has raised lines; nets behind those that make a goal.
fn goals(field: &FieldModel) -> Vec<Prop> {
    // Goals come from the field's own lines and landmarks, so that every template has its goals, or
    // none. Raised lines are posts and crossbars; four named posts make a goal with a net.
    let white = hex(0xF2_F3F2);
    let mut props: Vec<Prop> = Vec::new();
    for line in field.lines.iter().filter(|line| !line.painted) {
        let Curve::Segment { from, to } = line.curve else {
            continue;
        };
        // A line on the ground is the foot of a net or of boards, or is dashed.
        if from.z.max(to.z) <= 0.0 || line.id.as_str().starts_with("boards_") {
            continue;
        }
        // Posts stand on the crowned ground.
        let [from, to] = [from, to].map(|end| field.world_from_nominal(end));
        let stick = Stick::new(from, to, 0.5 * line.width_m, white);
        props.push(fixture(vec![stick], Vec::new(), true));
    }
    for side in ["left", "right"] {
        let corner = |which: &str, end: &str| field.landmark(&format!("post_{which}_{side}_{end}"));
        let corners = (
            corner("near", "base"),
            corner("far", "base"),
            corner("near", "top"),
        );
        if let (Some(near), Some(far), Some(top)) = corners {
            let raise = field.ground_z(near.nominal_m.y);
            let foot = |landmark: Vec3| Vec3::new(landmark.x, landmark.y, landmark.z + raise);
            props.push(net(
                foot(near.nominal_m),
                foot(far.nominal_m),
                top.nominal_m.z - near.nominal_m.z,
            ));
        }
    }
    props
}

/// A net that falls from the crossbar to the ground two metres behind it.
fn net(near: Vec3, far: Vec3, height_m: f64) -> Prop {
    // Four sheets: both sides, the back that slopes from the depth of the top to that of the foot,
    // and the top. Bars stretch them from the posts and between their shoulders.
    let (top_depth, foot_depth) = (0.9, 2.0);
    let out = Vec3::x() * near.x.signum();
    let across = (far - near).normalize();
    let breadth = (far - near).norm();
    let cord = Light::repeat(0.92);
    let mesh_m = Some([0.009, 0.12]);
    let slope = out * (top_depth - foot_depth) + Vec3::z() * height_m;
    let side = |corner: Vec3| Sheet {
        corner,
        across: out,
        up: Vec3::z(),
        breadth_m: [foot_depth, top_depth],
        height_m,
        mesh_m,
        albedo: cord,
    };
    let level = |corner: Vec3, up: Vec3| Sheet {
        corner,
        across,
        up: up.normalize(),
        breadth_m: [breadth; 2],
        height_m: up.norm(),
        mesh_m,
        albedo: cord,
    };
    let up = Vec3::z() * height_m;
    let sheets = vec![
        side(near),
        side(far),
        level(near + out * foot_depth, slope),
        level(near + up, out * top_depth),
    ];
    let bar = |from: Vec3, to: Vec3| Stick::new(from, to, 0.022, hex(0xD8_DADA));
    let sticks = [near, far]
        .into_iter()
        .flat_map(|post| {
            let shoulder = post + up + out * top_depth;
            [
                bar(post + up, shoulder),
                bar(shoulder, post + out * foot_depth),
            ]
        })
        .chain([bar(near + up + out * top_depth, far + up + out * top_depth)])
        .collect();
    fixture(sticks, sheets, false)
}

/// Corner flags under the landmarks that name their tops.
fn flags(field: &FieldModel) -> Vec<Prop> {
    field
        .landmarks
        .iter()
        .filter(|landmark| landmark.id.as_str().starts_with("corner_flag_"))
        .map(|landmark| {
            let top = field.landmark_in_world(landmark);
            let foot = Vec3::new(top.x, top.y, field.ground_z(top.y));
            let cloth = Sheet {
                corner: top - Vec3::z() * 0.36,
                across: Vec3::new(0.8, 0.6, 0.0),
                up: Vec3::z(),
                breadth_m: [0.46, 0.42],
                height_m: 0.33,
                mesh_m: None,
                albedo: hex(0xE8_4A1A),
            };
            let pole = Stick::new(foot, top, 0.022, hex(0xF0_E14A));
            Prop {
                sticks: vec![pole],
                sheets: vec![cloth],
                mover: None,
                throws_shadow: true,
            }
        })
        .collect()
}

/// Stewards and photographers in the strip behind the boards.
fn bystanders(options: &StadiumOptions) -> Vec<Prop> {
    // Each has a stretch of the strip and a random place in it: 26 along the far touchline, and 18
    // behind each goal. All face the pitch.
    let seed = sub_seed(options.seed, 0x57AD);
    let (field, [behind, beside]) = (&options.field, boards_m(options.scene));
    let (half_length, half_width) = (0.5 * field.length_m, 0.5 * field.width_m);
    let far = (0..26).map(|place| {
        let draw = hash(seed, place, 0);
        let x = -half_length + field.length_m * (f64::from(place) + f64::from(unit(draw))) / 26.0;
        (
            [
                x,
                half_width + beside + 1.2 + 1.5 * f64::from(unit(draw.rotate_left(5))),
            ],
            -std::f64::consts::FRAC_PI_2,
            draw,
        )
    });
    let ends = (0..36).map(|place| {
        let draw = hash(seed, place, 1);
        let side = if place % 2 == 0 { 1.0 } else { -1.0 };
        let y = -half_width + field.width_m * (f64::from(place) + f64::from(unit(draw))) / 36.0;
        let x = half_length + behind + 0.8 + 1.2 * f64::from(unit(draw.rotate_left(5)));
        (
            [side * x, y],
            if side > 0.0 {
                std::f64::consts::PI
            } else {
                0.0
            },
            draw,
        )
    });
    far.chain(ends)
        .map(|(place, facing, draw)| Prop {
            sticks: bystander(place, facing, draw),
            sheets: Vec::new(),
            mover: None,
            throws_shadow: false,
        })
        .collect()
}
