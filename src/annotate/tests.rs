//! Places of annotations, for many cameras.

use super::*;
use crate::base::color::Rgb;
use crate::base::math::{DAffine3, DVec2, DVec3, look_at};
use crate::base::time::{Rate, Time};
use crate::camera::{Camera, Projection, ThinLens};
use crate::drawing::{Canvas, Mark};
use crate::encode::{FrameInfo, SequenceInfo, Template};
use crate::testing::Random;

fn template(text: &str) -> Animated<Template> {
    Template::parse(text).expect("a template").into()
}

fn annotation(kind: AnnotationKind) -> Annotation {
    let style = Style { backdrop: Backdrop::None, ..Style::default() };
    Annotation { visible: true.into(), opacity: 1.0.into(), style, values: Vec::new(), kind }
}

fn camera() -> Camera {
    let position = DVec3::new(0.0, 0.0, 10.0);
    let basis = look_at(position, DVec3::ZERO, DVec3::Y).expect("a frame");
    Camera { position, basis, projection: Projection::Perspective { half_height: 0.4 }, lens: None }
}

/// Draws annotations in a world without objects, in which nothing is hidden or everything.
fn drawn(annotations: &[Annotation], camera: Camera, size: (u32, u32), hidden: bool) -> Drawing {
    let sequence = SequenceInfo { frames: 11, ..SequenceInfo::default() };
    let rate = Rate::new(10, 1).expect("a rate");
    let still = PlacedObject { to_world: DAffine3::IDENTITY, bounds: None, visible: true };
    let view = FrameView {
        camera,
        size,
        time: Time::new(1, 2),
        info: FrameInfo { sequence: &sequence, frame: 5, rate },
        axes: [DVec3::X, DVec3::Y, DVec3::Z],
        object: &|_, _| still,
        is_hidden: &|_, _| hidden,
    };
    drawing(annotations, &view)
}

/// The covered pixels of a drawing with their coverage.
struct Coverages((u32, u32), Vec<f64>);

impl Canvas for Coverages {
    fn size(&self) -> (u32, u32) {
        self.0
    }

    fn blend(&mut self, pixel: usize, _: [f64; 3], opacity: f64) {
        self.1[pixel] += opacity * (1.0 - self.1[pixel]);
    }
}

fn label(text: &str, at: DVec3, offset: Offset) -> Label {
    let at = Anchor::World(at.into());
    Label { text: template(text), at, offset, leader: true, behind: Behind::Show, avoid: true }
}

/// The dots of leaders, as they are rasterised, are within a tenth of a pixel of where the camera's rays meet the
/// points: for perspective and orthographic cameras, with a lens and with any zoom.
#[test]
fn anchors_are_exact() {
    let (size, mut random) = ((320, 200), Random(3));
    let (mut seen, mut worst) = (0, 0.0f64);
    for index in 0..3000 {
        let position = random.point(8.0);
        let Some(basis) = look_at(position, random.point(2.0), DVec3::Y) else { continue };
        // Fields of view from 0.1 to 120 degrees.
        let half_height = 1e-3 * libm::pow(1700.0, random.unit());
        let projection = match index % 2 {
            0 => Projection::Perspective { half_height },
            _ => Projection::Orthographic { half_height: 4.0 * half_height },
        };
        let lens = (index % 3 == 0).then_some(ThinLens { radius: 0.3, focus: 5.0 });
        let camera = Camera { position, basis, projection, lens };
        // A place of the picture, and a point on the ray through it.
        let place = DVec2::new(300.0 * random.unit() + 10.0, 180.0 * random.unit() + 10.0);
        let screen = DVec2::new((place.x - 160.0) / 100.0, (100.0 - place.y) / 100.0);
        let point = Camera { lens: None, ..camera }.ray(screen, DVec2::ZERO).at(0.1 + 20.0 * random.unit());
        let far = label(".", point, Offset::Pixels(DVec2::ZERO));
        let marks = drawn(&[annotation(AnnotationKind::Label(far))], camera, size, false).marks;
        let dot = marks.into_iter().find(|mark| matches!(mark, Mark::Fill { .. })).expect("a dot");
        let mut pixels = Coverages(size, vec![0.0; 320 * 200]);
        Drawing { marks: vec![dot] }.draw(&mut pixels);
        let total: f64 = pixels.1.iter().sum();
        let middle = pixels.1.iter().enumerate().map(|(index, coverage)| {
            DVec2::new((index % 320) as f64 + 0.5, (index / 320) as f64 + 0.5) * (*coverage / total)
        });
        let away = (middle.sum::<DVec2>() - place).length();
        assert!(away < 0.1, "{away} pixels at {place}");
        worst = worst.max(away);
        seen += 1;
    }
    assert!(seen > 2900 && worst < 0.05, "{seen} {worst}");
}

#[test]
fn what_is_behind_the_camera_is_not_drawn() {
    let far = |z: f64| annotation(AnnotationKind::Label(label("x", DVec3::new(0.0, 0.0, z), Offset::ZERO)));
    assert!(!drawn(&[far(0.0)], camera(), (160, 90), false).is_empty());
    assert!(drawn(&[far(10.0), far(11.0), far(400.0)], camera(), (160, 90), false).is_empty());
    // A line through the camera's plane keeps its visible part, with coordinates near the picture.
    let to = [DVec3::new(3.0, 1.0, -5.0), DVec3::new(-3.0, 1.0, 25.0)].map(|end| Anchor::World(end.into()));
    let [from, to] = to;
    let line = LineMark { from, to, heads: Default::default() };
    let marks = drawn(&[annotation(AnnotationKind::Line(line))], camera(), (160, 90), false).marks;
    let Some(Mark::Stroke { lines, .. }) = marks.first() else { panic!("no line: {marks:?}") };
    assert!(lines[0].points.iter().all(|point| point.abs().max_element() < 1000.0), "{lines:?}");
}

#[test]
fn hidden_labels_vanish_or_fade() {
    let with = |behind, hidden| {
        let label = Label { behind, ..label("x", DVec3::ZERO, Offset::ZERO) };
        drawn(&[annotation(AnnotationKind::Label(label))], camera(), (160, 90), hidden)
    };
    let opacity = |drawing: &Drawing| match drawing.marks.first()? {
        Mark::Group { opacity, .. } => Some(*opacity),
        _ => Some(1.0),
    };
    assert_eq!([Behind::Hide, Behind::Fade, Behind::Show].map(|b| opacity(&with(b, false))), [Some(1.0); 3]);
    assert_eq!(
        [Behind::Hide, Behind::Fade, Behind::Show].map(|b| opacity(&with(b, true))),
        [None, Some(0.3), Some(1.0)]
    );
}

#[test]
fn labels_avoid_each_other_and_stay_in_the_picture() {
    let at =
        |x: f64| annotation(AnnotationKind::Label(label("a label", DVec3::new(x, 0.1, 0.0), Offset::ZERO)));
    let all: Vec<_> = [0.0, 0.1, 0.2, -0.1, 6.9, -6.9].map(at).to_vec();
    for size in [(160, 90), (640, 360), (3840, 2160)] {
        let drawing = drawn(&all, camera(), size, false);
        let boxes: Vec<_> = drawing.text_boxes().map(|(_, bounds)| bounds).collect();
        assert_eq!(boxes.len(), 6);
        for (index, [corner, extent]) in boxes.iter().enumerate() {
            let end = *corner + *extent;
            assert!(corner.min_element() >= 0.0 && end.x <= f64::from(size.0) && end.y <= f64::from(size.1));
            assert!(
                boxes[..index].iter().all(|other| !painter::touch([*corner, *extent], *other)),
                "{size:?}"
            );
        }
    }
}

#[test]
fn blocks_keep_out_of_each_others_way() {
    let caption = |text: &str, place| {
        let position = PanelPosition { place, offset: Offset::ZERO };
        annotation(AnnotationKind::Caption(CaptionText { text: template(text), position }))
    };
    let all: Vec<_> = PanelPlace::NAMED
        .iter()
        .flat_map(|(name, place)| [caption(name, *place), caption("two\nlines", *place)])
        .collect();
    let drawing = drawn(&all, camera(), (640, 360), false);
    let boxes: Vec<_> = drawing.text_boxes().map(|(_, bounds)| bounds).collect();
    assert_eq!(boxes.len(), 27);
    for (index, one) in boxes.iter().enumerate() {
        assert!(boxes[..index].iter().all(|other| !painter::touch(*one, *other)), "{one:?}");
    }
}

#[test]
fn labels_avoid_blocks_that_are_drawn_later() {
    let position = PanelPosition { place: PanelPlace::Center, offset: Offset::ZERO };
    let block = annotation(AnnotationKind::Caption(CaptionText { text: template("a block"), position }));
    let label = annotation(AnnotationKind::Label(label("a label", DVec3::ZERO, Offset::ZERO)));
    let boxes = |all: &[Annotation]| -> Vec<painter::PixelBox> {
        drawn(all, camera(), (640, 360), false).text_boxes().map(|(_, bounds)| bounds).collect()
    };
    let (before, after) = (boxes(&[label.clone(), block.clone()]), boxes(&[block.clone(), label.clone()]));
    assert!(!painter::touch(before[0], before[1]), "{before:?}");
    assert_eq!((before[0], before[1]), (after[1], after[0]));
    // The block stays where it is without the label.
    assert_eq!(boxes(&[block])[0], before[1]);
    assert!(painter::touch(boxes(&[label])[0], before[1]));
}

#[test]
fn a_caption_changes_its_corner_only() {
    for (name, place) in PanelPlace::NAMED {
        let AnnotationKind::Caption(caption) = Annotation::caption(Template::default()).kind else {
            panic!()
        };
        let position = PanelPosition { place, ..caption.position };
        let text = template("{frame}");
        let kind = AnnotationKind::Caption(CaptionText { text, position });
        let drawing = drawn(&[annotation(kind)], camera(), (240, 120), false);
        let mut covered = Coverages((240, 120), vec![0.0; 240 * 120]);
        drawing.draw(&mut covered);
        // The ninths of the picture in which something is drawn.
        let ninth = |pixel: usize| (pixel % 240 / 80, pixel / 240 / 40);
        let places = (0..240 * 120).filter(|pixel| covered.1[*pixel] > 0.0).map(ninth);
        let shares = place.shares() * 2.0;
        let expected = (shares.x as usize, shares.y as usize);
        assert_eq!(places.collect::<std::collections::BTreeSet<_>>(), [expected].into(), "{name}");
    }
}

#[test]
fn captions_that_do_not_fit_are_reported() {
    let caption = |text: &str| {
        let caption = Annotation::caption(Template::parse(text).expect("a template"));
        Annotation { style: Style { size: 0.1, ..caption.style.clone() }, ..caption }
    };
    let nine = "a\nb\nc\nd\ne\nf\ng\nh\n{frame}";
    assert_eq!(caption(nine).overflow(200), None);
    let ten = format!("{nine}\ni");
    let expected = "10 lines; pictures 200 pixels high have room for 9, and the rest is cut off";
    assert_eq!(caption(&ten).overflow(200).as_deref(), Some(expected));
    // Letters have a minimum height.
    let expected = "1 line; pictures 4 pixels high have room for 0, and the rest is cut off";
    assert_eq!(caption("a").overflow(4).as_deref(), Some(expected));
    // What is said to fit is within the picture, and what is said not to fit is not.
    for (text, fits) in [(nine, true), (&ten, false)] {
        let drawing = drawn(&[caption(text)], camera(), (200, 200), false);
        let tops = drawing.text_boxes().map(|(_, [corner, _])| corner.y);
        assert_eq!(tops.fold(f64::INFINITY, f64::min) >= 0.0, fits, "{text:?}");
    }
}

#[test]
fn texts_insert_numbers_of_the_frame() {
    let label = Label {
        text: Template::with_values("{time:.3} {frame} {v:+.1}", &["v"]).expect("a template").into(),
        ..label("", DVec3::ZERO, Offset::ZERO)
    };
    let annotation = Annotation { values: vec![(-2.25).into()], ..annotation(AnnotationKind::Label(label)) };
    let drawing = drawn(&[annotation], camera(), (640, 360), false);
    let texts: Vec<_> = drawing.text_boxes().map(|(text, _)| text.text.clone()).collect();
    assert_eq!(texts, ["0.500 05 −2.2"]);
}

#[test]
fn lengths_and_angles_are_measured() {
    let point = |x: f64, y: f64| Anchor::World(DVec3::new(x, y, 0.0).into());
    let text =
        |name: &str| Template::with_values(&format!("{{{name}:.4}}"), &[name]).expect("a template").into();
    let dimension =
        Dimension { from: point(0.0, 0.0), to: point(1.5, 2.0), offset: 0.1, text: text("length") };
    let angle = AngleArc {
        at: point(0.0, 0.0),
        from: point(2.0, 0.0),
        to: point(-1.0, 1.0),
        radius: 0.5,
        text: text("angle"),
    };
    let all = [annotation(AnnotationKind::Dimension(dimension)), annotation(AnnotationKind::Angle(angle))];
    let drawing = drawn(&all, camera(), (640, 360), false);
    let texts: Vec<_> = drawing.text_boxes().map(|(text, _)| text.text.clone()).collect();
    assert_eq!(texts, ["2.5000", "135.0000"]);
}

#[test]
fn scales_are_as_long_as_they_say() {
    let projection = Projection::Orthographic { half_height: 5.0 };
    let camera = Camera { projection, ..camera() };
    let bar = ScaleBar {
        position: PanelPosition { place: PanelPlace::BottomRight, offset: Offset::ZERO },
        length: Some(2.0),
        at: None,
        unit: "m".into(),
    };
    let drawing = drawn(&[annotation(AnnotationKind::ScaleBar(bar))], camera, (640, 360), false);
    let Some(Mark::Stroke { lines, .. }) =
        drawing.marks.iter().find(|mark| matches!(mark, Mark::Stroke { .. }))
    else {
        panic!("no bar")
    };
    // 10 units are 360 pixels high.
    assert!((lines[0].points[1].x - lines[0].points[0].x - 72.0).abs() < 1e-9);
}

#[test]
fn nothing_flickers_where_nothing_moves() {
    let style = Style { color: Rgb::new(0.2, 0.4, 0.9).into(), ..Style::default() };
    let label =
        annotation(AnnotationKind::Label(label("still", DVec3::X, Offset::Relative(DVec2::splat(0.1)))));
    let all = [Annotation { style, ..label }];
    let one = drawn(&all, camera(), (640, 360), false);
    assert_eq!(one, drawn(&all, camera(), (640, 360), false));
}
