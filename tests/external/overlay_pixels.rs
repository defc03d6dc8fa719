//! What the off-screen renderer draws, compared with what the processor works out on its own.

use crate::parts::{Test, tests};
use image::{Rgba, RgbaImage};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};
use touchline::geometry::ImageSize;
use touchline::media;
use touchline::render::{Layer, Offscreen, PictureKey, PictureLayer, View};
use touchline::scene::PictureLook;
use touchline::scene::drawing::{
    Area, Colour, Dash, Drawing, Marker, MarkerShape, Outline, Stroke, StrokeGroup,
};

pub const TESTS: &[Test] = tests![
    [Adapter] a_picture_at_its_own_size_keeps_every_pixel;
    [Adapter] beyond_400_percent_the_bare_pixels_show;
    [Adapter] a_reduced_picture_is_the_mean_of_what_it_shows;
    [Adapter] a_picture_beyond_the_limit_of_the_adapter_is_shown_all_the_same;
    [Adapter] pictures_with_one_key_are_uploaded_once_and_leave_in_turn;
    [Adapter] a_stroke_covers_each_pixel_as_far_as_its_shape_does;
    [Adapter] a_translucent_group_is_even_where_strokes_join_and_cross;
    [Adapter] a_clipped_group_ends_at_its_box;
    [Adapter] dashes_have_their_length_and_their_gaps;
    [Adapter] a_cross_leaves_the_clicked_pixel_open_and_a_ring_is_round;
    [Adapter] an_area_covers_its_size_with_soft_edges;
    [Adapter] a_canvas_without_pixels_is_refused_by_name;
];

const WHITE: Colour = Colour::rgb(255, 255, 255);
const BLACK: Colour = Colour::rgb(0, 0, 0);

/// One device for all tests: starting one costs more than drawing.
pub fn offscreen() -> MutexGuard<'static, Offscreen> {
    static DEVICE: OnceLock<Mutex<Offscreen>> = OnceLock::new();
    DEVICE
        .get_or_init(|| Mutex::new(Offscreen::new().unwrap()))
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn draw(size: [u32; 2], drawing: Drawing) -> RgbaImage {
    offscreen()
        .render(
            &View::one_to_one(size),
            BLACK,
            &[Layer::Drawing(Arc::new(drawing))],
        )
        .unwrap()
}

fn stroke(points: Vec<[f32; 2]>, width_pt: f32) -> Stroke {
    Stroke {
        points,
        colour: WHITE,
        width_pt,
        outline: None,
        dash: None,
    }
}

fn group(strokes: Vec<Stroke>, opacity: f32) -> Drawing {
    Drawing {
        strokes: vec![StrokeGroup {
            strokes,
            opacity,
            clip_px: None,
        }],
        ..Drawing::default()
    }
}

fn circle(centre: [f32; 2], radius: f32, points: u32) -> Vec<[f32; 2]> {
    let mut points: Vec<[f32; 2]> = (0..points)
        .map(|i| {
            let (sin, cos) = (i as f32 / points as f32 * std::f32::consts::TAU).sin_cos();
            [centre[0] + radius * cos, centre[1] + radius * sin]
        })
        .collect();
    points.push(points[0]);
    points
}

fn distance_to_polyline(p: [f32; 2], points: &[[f32; 2]]) -> f32 {
    points
        .windows(2)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let (ab, ap) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            let t =
                ((ap[0] * ab[0] + ap[1] * ab[1]) / (ab[0] * ab[0] + ab[1] * ab[1])).clamp(0.0, 1.0);
            (ap[0] - t * ab[0]).hypot(ap[1] - t * ab[1])
        })
        .fold(f32::INFINITY, f32::min)
}

/// A picture in which every pixel differs from its neighbours.
fn noise(width: u32, height: u32) -> RgbaImage {
    RgbaImage::from_fn(width, height, |x, y| {
        let mixed = (x * 7919 + y * 104_729).wrapping_mul(2_654_435_761);
        Rgba([
            (mixed >> 24) as u8,
            (mixed >> 16) as u8,
            (mixed >> 8) as u8,
            255,
        ])
    })
}

fn picture(key: u64, pixels: RgbaImage) -> Layer {
    let size = ImageSize::new(pixels.width(), pixels.height());
    let pixels = media::Picture::new(size, pixels.into_raw()).unwrap();
    Layer::Picture(PictureLayer {
        key: PictureKey(key),
        pixels,
        look: PictureLook::default(),
    })
}

fn a_picture_at_its_own_size_keeps_every_pixel() {
    let pixels = noise(317, 205);
    let drawn = offscreen()
        .render(
            &View::one_to_one([317, 205]),
            BLACK,
            &[picture(1, pixels.clone())],
        )
        .unwrap();
    assert!(drawn == pixels);
}

fn beyond_400_percent_the_bare_pixels_show() {
    let pixels = noise(40, 30);
    let view = View {
        scale: 8.0,
        offset_px: [-24.0, -16.0],
        ..View::one_to_one([200, 160])
    };
    let drawn = offscreen()
        .render(&view, BLACK, &[picture(2, pixels.clone())])
        .unwrap();
    for (x, y, pixel) in drawn.enumerate_pixels() {
        assert_eq!(
            pixel,
            pixels.get_pixel((x + 24) / 8, (y + 16) / 8),
            "canvas pixel {x}, {y}"
        );
    }
    let smooth = View { scale: 4.0, ..view };
    let drawn = offscreen()
        .render(&smooth, BLACK, &[picture(2, pixels)])
        .unwrap();
    let colours: std::collections::BTreeSet<[u8; 4]> =
        drawn.pixels().map(|pixel| pixel.0).collect();
    assert!(
        colours.len() > 2000,
        "at 400 % the picture is smooth: {} colours",
        colours.len()
    );
}

fn a_reduced_picture_is_the_mean_of_what_it_shows() {
    let checks = RgbaImage::from_fn(1024, 768, |x, y| {
        if (x + y) % 2 == 0 {
            Rgba([255; 4])
        } else {
            Rgba([0, 0, 0, 255])
        }
    });
    let view = View::fit([1024, 768], [300, 300]);
    let drawn = offscreen()
        .render(&view, Colour::rgb(9, 9, 9), &[picture(3, checks)])
        .unwrap();
    assert_eq!(
        drawn.get_pixel(150, 10).0,
        [9, 9, 9, 255],
        "the margin shows the background"
    );
    for (_, _, pixel) in drawn
        .enumerate_pixels()
        .filter(|(_, y, _)| (40..260).contains(y))
    {
        assert!(
            pixel.0[0].abs_diff(128) <= 2,
            "a fine check pattern turns grey, not into waves: {pixel:?}"
        );
    }
}

fn a_picture_beyond_the_limit_of_the_adapter_is_shown_all_the_same() {
    let wide = RgbaImage::from_fn(40_000, 4, |x, _| {
        if x < 20_000 {
            Rgba([200, 0, 0, 255])
        } else {
            Rgba([0, 0, 200, 255])
        }
    });
    let view = View {
        scale: 2.0,
        offset_px: [-39_970.0, 0.0],
        ..View::one_to_one([60, 8])
    };
    let drawn = offscreen()
        .render(&view, BLACK, &[picture(4, wide)])
        .unwrap();
    assert_eq!(
        (drawn.get_pixel(5, 4).0, drawn.get_pixel(54, 4).0),
        ([200, 0, 0, 255], [0, 0, 200, 255])
    );
}

fn pictures_with_one_key_are_uploaded_once_and_leave_in_turn() {
    let mut offscreen = offscreen();
    let view = View::one_to_one([4, 4]);
    let flat = |byte| RgbaImage::from_pixel(4, 4, Rgba([byte, byte, byte, 255]));
    let mut shown = |key, byte| {
        offscreen
            .render(&view, BLACK, &[picture(key, flat(byte))])
            .unwrap()
            .get_pixel(1, 1)
            .0[0]
    };
    assert_eq!(shown(100, 10), 10);
    assert_eq!(shown(100, 20), 10, "the key says that nothing changed");
    for key in 101..120 {
        assert_eq!(shown(key, key as u8), key as u8);
    }
    assert_eq!(
        shown(100, 20),
        20,
        "forgotten meanwhile, hence uploaded again"
    );
}

fn a_stroke_covers_each_pixel_as_far_as_its_shape_does() {
    let shapes = [
        vec![[10.3, 12.7], [180.2, 40.1], [60.5, 100.9], [61.0, 150.0]],
        circle([100.0, 80.0], 55.4, 200),
        circle([100.5, 80.5], 30.0, 24),
    ];
    for points in shapes {
        for width in [1.0, 2.5, 6.0] {
            let drawn = draw([200, 160], group(vec![stroke(points.clone(), width)], 1.0));
            for (x, y, pixel) in drawn.enumerate_pixels() {
                let distance = distance_to_polyline([x as f32 + 0.5, y as f32 + 0.5], &points);
                let expected = (width / 2.0 - distance + 0.5).clamp(0.0, 1.0)
                    - (-width / 2.0 - distance + 0.5).clamp(0.0, 1.0);
                let got = f32::from(pixel.0[0]) / 255.0;
                assert!(
                    (got - expected).abs() < 0.02,
                    "pixel {x}, {y}, width {width}: {got} instead of {expected}"
                );
            }
        }
    }
}

fn a_translucent_group_is_even_where_strokes_join_and_cross() {
    let wave: Vec<[f32; 2]> = (0..400)
        .map(|i| {
            [
                10.0 + i as f32 * 0.45,
                60.0 + 30.0 * (i as f32 * 0.03).sin(),
            ]
        })
        .collect();
    let rim = Some(Outline {
        colour: Colour::rgb(0, 0, 255),
        width_pt: 1.5,
    });
    let with_rim = |points| Stroke {
        outline: rim,
        ..stroke(points, 5.0)
    };
    let strokes = vec![
        with_rim(wave.clone()),
        with_rim(vec![[100.0, 5.0], [100.0, 60.0], [100.0, 115.0]]),
        with_rim(vec![[20.0, 20.0], [180.0, 20.0]]),
    ];
    let centres: Vec<[f32; 2]> = wave
        .iter()
        .copied()
        .chain((10..110).map(|y| [100.0, y as f32]))
        .collect();
    let drawn = draw([200, 120], group(strokes, 0.5));
    for centre in centres {
        let pixel = drawn.get_pixel(centre[0] as u32, centre[1] as u32).0;
        assert!(
            pixel[..3].iter().all(|channel| channel.abs_diff(128) <= 1),
            "at {centre:?}: {pixel:?}"
        );
    }
    let brightest = drawn.pixels().map(|pixel| pixel.0[2]).max();
    assert!(
        brightest <= Some(128),
        "nothing is covered twice: {brightest:?}"
    );
}

fn a_clipped_group_ends_at_its_box() {
    let mut drawing = group(vec![stroke(vec![[-5.0, 10.5], [60.0, 10.5]], 3.0)], 1.0);
    drawing.strokes[0].clip_px = Some([8.0, 4.0, 20.0, 11.0]);
    let view = View {
        scale: 2.0,
        offset_px: [-10.0, -10.0],
        ..View::one_to_one([60, 40])
    };
    let drawn = offscreen()
        .render(&view, BLACK, &[Layer::Drawing(Arc::new(drawing))])
        .unwrap();
    for (x, y, pixel) in drawn.enumerate_pixels() {
        let inside = (6..30).contains(&x) && y < 12;
        assert!(
            inside || pixel.0[0] == 0,
            "pixel {x}, {y} lies outside the box"
        );
    }
    assert_eq!(
        (drawn.get_pixel(6, 11).0[0], drawn.get_pixel(29, 11).0[0]),
        (255, 255)
    );
}

fn dashes_have_their_length_and_their_gaps() {
    let dashed = Stroke {
        dash: Some(Dash {
            on_pt: 12.0,
            off_pt: 8.0,
        }),
        ..stroke(vec![[10.0, 10.5], [50.0, 10.5], [190.0, 10.5]], 2.0)
    };
    let drawn = draw([200, 21], group(vec![dashed], 1.0));
    for x in 10..190_u32 {
        let phase = (x as f32 + 0.5 - 10.0) % 20.0;
        let lit = drawn.get_pixel(x, 10).0[0];
        match phase {
            0.5..12.0 => assert_eq!(lit, 255, "dash at {x}"),
            14.0..18.0 => assert_eq!(lit, 0, "gap at {x}"),
            _ => {}
        }
    }
}

fn a_cross_leaves_the_clicked_pixel_open_and_a_ring_is_round() {
    let marker = |shape| Marker {
        at: [20.5, 20.5],
        shape,
        colour: WHITE,
        radius_pt: 10.0,
        line_pt: 2.0,
        outline: None,
    };
    let drawn = |shape| {
        draw(
            [41, 41],
            Drawing {
                markers: vec![marker(shape)],
                ..Drawing::default()
            },
        )
    };
    let lit = |image: &RgbaImage, x, y| image.get_pixel(x, y).0[0];
    let cross = drawn(MarkerShape::Cross);
    assert_eq!(
        (
            lit(&cross, 20, 20),
            lit(&cross, 27, 20),
            lit(&cross, 20, 13),
            lit(&cross, 27, 27)
        ),
        (0, 255, 255, 0)
    );
    let ring = drawn(MarkerShape::Ring);
    assert_eq!(
        (
            lit(&ring, 20, 20),
            lit(&ring, 29, 20),
            lit(&ring, 20, 11),
            lit(&ring, 32, 20)
        ),
        (0, 255, 255, 0)
    );
    let dot = drawn(MarkerShape::Dot);
    assert_eq!(
        (lit(&dot, 20, 20), lit(&dot, 27, 20), lit(&dot, 31, 20)),
        (255, 255, 0)
    );
    let diamond = drawn(MarkerShape::Diamond);
    assert_eq!(
        (
            lit(&diamond, 20, 20),
            lit(&diamond, 29, 20),
            lit(&diamond, 27, 27)
        ),
        (0, 255, 0)
    );
}

fn an_area_covers_its_size_with_soft_edges() {
    let corners = vec![
        [10.25, 10.5],
        [90.75, 12.0],
        [80.0, 70.5],
        [45.5, 30.0],
        [12.0, 60.25],
    ];
    let exact: f32 = (0..5)
        .map(|i| corners[i][0] * corners[(i + 1) % 5][1] - corners[i][1] * corners[(i + 1) % 5][0])
        .sum::<f32>()
        / 2.0;
    let drawn = draw(
        [100, 80],
        Drawing {
            areas: vec![Area {
                corners,
                colour: WHITE,
            }],
            ..Drawing::default()
        },
    );
    let covered: f32 = drawn
        .pixels()
        .map(|pixel| f32::from(pixel.0[0]) / 255.0)
        .sum();
    assert!(
        (covered - exact).abs() < 0.003 * exact,
        "{covered} px instead of {exact}"
    );
}

fn a_canvas_without_pixels_is_refused_by_name() {
    let error = offscreen()
        .render(&View::one_to_one([0, 5]), BLACK, &[])
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("a canvas of 0 × 5 px cannot be rendered"),
        "{error}"
    );
}
