//! FLIP: the difference that a person sees who alternates between two pictures (Andersson, Nilsson, Akenine-Möller,
//! Oskarsson, Åström, Fairchild, *FLIP: A Difference Evaluator for Alternating Images*, 2020). Constants without a
//! comment are the paper's.

use super::kernel::GrayImage;
use crate::base::color::srgb_to_linear;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, SQRT_2};

/// The paper's viewing conditions: a screen 0.7 m wide with 3840 pixels, viewed from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Exponent of colour differences.
const COLOR_EXPONENT: f64 = 0.7;
/// Exponent of feature differences.
const FEATURE_EXPONENT: f64 = 0.5;
/// This fraction of the largest colour difference is mapped to [`KNEE_VALUE`].
const KNEE: f64 = 0.4;
const KNEE_VALUE: f64 = 0.95;
/// Width of the feature detectors for edges and points, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// The eye's contrast sensitivity: sums of Gaussians (a, b) with the spectrum a·exp(-b f²), of f cycles per degree.
const ACHROMATIC: &[(f64, f64)] = &[(1.0, 0.0047)];
const RED_GREEN: &[(f64, f64)] = &[(1.0, 0.0053)];
const BLUE_YELLOW: &[(f64, f64)] = &[(34.1, 0.04), (13.5, 0.025)];
/// The widest Gaussian: the radius of all filters is three of its standard deviations.
const WIDEST: f64 = 0.04;

/// The white point D65 in XYZ.
const WHITE: DVec3 = DVec3::new(0.950_428_545, 1.0, 1.088_900_371);

/// A filtered reference picture that other pictures are compared with.
#[derive(Clone, Debug)]
pub struct Flip {
    filters: Filters,
    reference: FilteredImage,
}

/// The filters for a viewing distance.
#[derive(Clone, Debug)]
struct Filters {
    pixels_per_degree: f64,
    /// Weights of the edge and of the point detector along its axis; `across` holds those perpendicular to it.
    edge: Vec<f64>,
    point: Vec<f64>,
    across: Vec<f64>,
}

/// A picture after the paper's colour and feature pipelines.
#[derive(Clone, Debug)]
struct FilteredImage {
    /// Filtered colours, in Hunt-adjusted L*a*b*.
    colors: Vec<DVec3>,
    edges: GrayImage,
    points: GrayImage,
}

impl Flip {
    /// `reference` holds displayed (sRGB-coded) values in 0..=1, row by row.
    pub fn new(reference: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Self {
        let filters = Filters::new(pixels_per_degree);
        let reference = filters.filter(reference, width);
        Self { filters, reference }
    }

    /// How different each pixel of a picture of the same size looks, from 0 to 1.
    pub fn map(&self, picture: &[[f32; 3]]) -> Vec<f32> {
        let other = self.filters.filter(picture, self.reference.edges.width);
        let largest = largest_color_difference();
        let pixel = |i: usize| {
            let color = color_difference(self.reference.colors[i], other.colors[i]);
            let color = redistributed(libm::pow(color, COLOR_EXPONENT), largest);
            let edge = (self.reference.edges.values[i] - other.edges.values[i]).abs();
            let point = (self.reference.points.values[i] - other.points.values[i]).abs();
            let feature = libm::pow(edge.max(point) / SQRT_2, FEATURE_EXPONENT);
            libm::pow(color, 1.0 - feature) as f32
        };
        (0..picture.len()).map(pixel).collect()
    }

    /// The mean of the map.
    pub fn mean(&self, picture: &[[f32; 3]]) -> f64 {
        self.map(picture).iter().map(|&value| f64::from(value)).sum::<f64>() / picture.len().max(1) as f64
    }
}

impl Filters {
    fn new(pixels_per_degree: f64) -> Self {
        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let gauss = |x: f64| libm::exp(-x * x / (2.0 * deviation * deviation));
        let across = weights((3.0 * deviation).ceil(), gauss);
        let edge = weights((3.0 * deviation).ceil(), |x| -x * gauss(x));
        let point = weights((3.0 * deviation).ceil(), |x| (x * x / (deviation * deviation) - 1.0) * gauss(x));
        // The positive weights of the 2D filter add up to 1, the negative ones to -1.
        let (edge, point) = (balanced(&edge), balanced(&point));
        Self { pixels_per_degree, edge, point, across: scaled(&across, 1.0 / across.iter().sum::<f64>()) }
    }

    fn filter(&self, displayed: &[[f32; 3]], width: usize) -> FilteredImage {
        let opponent: Vec<DVec3> = displayed.iter().map(|color| opponent(xyz(linear(*color)))).collect();
        let channel =
            |axis: usize| GrayImage { width, values: opponent.iter().map(|color| color[axis]).collect() };
        let luminance =
            GrayImage { width, values: opponent.iter().map(|color| (color.x + 16.0) / 116.0).collect() };
        let filtered = [(0, ACHROMATIC), (1, RED_GREEN), (2, BLUE_YELLOW)];
        let [y, cx, cz] = filtered.map(|(axis, sensitivity)| self.filtered(&channel(axis), sensitivity));
        let color = |i: usize| {
            let linear = rgb(from_opponent(DVec3::new(y.values[i], cx.values[i], cz.values[i])));
            hunt_adjusted(lab(xyz(linear.clamp(DVec3::ZERO, DVec3::ONE))))
        };
        FilteredImage {
            colors: (0..opponent.len()).map(color).collect(),
            edges: self.features(&luminance, &self.edge),
            points: self.features(&luminance, &self.point),
        }
    }

    /// A channel, filtered by the contrast sensitivity.
    fn filtered(&self, channel: &GrayImage, sensitivity: &[(f64, f64)]) -> GrayImage {
        let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * self.pixels_per_degree).ceil();
        let parts = sensitivity.iter().map(|&(a, b)| {
            let along = weights(radius, |x| {
                let degrees = x / self.pixels_per_degree;
                libm::exp(-PI * PI * degrees * degrees / b)
            });
            let sum: f64 = along.iter().sum();
            (along, sum, a * (PI / b).sqrt())
        });
        let parts: Vec<_> = parts.collect();
        let whole: f64 = parts.iter().map(|(_, sum, share)| share * sum * sum).sum();
        let planes =
            parts.iter().map(|(along, _, share)| channel.filtered(&scaled(along, share / whole), along));
        planes.reduce(|a, b| a.combined(&b, |a, b| a + b)).unwrap_or_else(|| channel.clone())
    }

    /// The response of a detector: the length of the vector of its horizontal and its vertical response.
    fn features(&self, luminance: &GrayImage, detector: &[f64]) -> GrayImage {
        let across = luminance.filtered(detector, &self.across);
        let down = luminance.filtered(&self.across, detector);
        across.combined(&down, |x, y| (x * x + y * y).sqrt())
    }
}

/// Weights of a filter of this radius, in pixels.
fn weights(radius: f64, of: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| of(f64::from(x))).collect()
}

fn scaled(weights: &[f64], by: f64) -> Vec<f64> {
    weights.iter().map(|weight| weight * by).collect()
}

/// Scales the positive weights to a sum of 1, and the negative ones to a sum of -1.
fn balanced(weights: &[f64]) -> Vec<f64> {
    let positive: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    weights.iter().map(|&weight| if weight < 0.0 { weight / negative } else { weight / positive }).collect()
}

/// Maps differences to 0..=1; those below a knee use most of that range.
fn redistributed(difference: f64, largest: f64) -> f64 {
    let knee = KNEE * largest;
    if difference < knee {
        KNEE_VALUE / knee * difference
    } else {
        KNEE_VALUE + (difference - knee) / (largest - knee) * (1.0 - KNEE_VALUE)
    }
}

/// The difference between pure green and pure blue, with the exponent of all colour differences.
fn largest_color_difference() -> f64 {
    let [green, blue] = [DVec3::Y, DVec3::Z].map(|linear| hunt_adjusted(lab(xyz(linear))));
    libm::pow(color_difference(green, blue), COLOR_EXPONENT)
}

/// The HyAB distance: the absolute difference of lightness plus the Euclidean distance of a and b.
fn color_difference(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

/// Hunt effect: the chroma decreases with the lightness.
fn hunt_adjusted(lab: DVec3) -> DVec3 {
    DVec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

fn linear(displayed: [f32; 3]) -> DVec3 {
    DVec3::from_array(displayed.map(|value| srgb_to_linear(f64::from(value).clamp(0.0, 1.0))))
}

/// Linear sRGB to XYZ.
const XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    DVec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    DVec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

/// XYZ to linear sRGB, as rounded in the authors' programs.
const RGB: DMat3 = DMat3::from_cols(
    DVec3::new(3.241_003_275, -0.969_224_334, 0.055_639_423),
    DVec3::new(-1.537_398_934, 1.875_930_071, -0.204_011_202),
    DVec3::new(-0.498_615_861, 0.041_554_224, 1.057_148_933),
);

fn xyz(linear: DVec3) -> DVec3 {
    XYZ * linear
}

fn rgb(xyz: DVec3) -> DVec3 {
    RGB * xyz
}

/// XYZ to YCxCz: linearized L*a*b*, for spatial filters.
fn opponent(xyz: DVec3) -> DVec3 {
    let v = xyz / WHITE;
    DVec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}

fn from_opponent(color: DVec3) -> DVec3 {
    let y = (color.x + 16.0) / 116.0;
    DVec3::new(y + color.y / 500.0, y, y - color.z / 200.0) * WHITE
}

/// CIE L*a*b*.
fn lab(xyz: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| {
        if t > DELTA * DELTA * DELTA { libm::cbrt(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let v = DVec3::from_array((xyz / WHITE).to_array().map(root));
    DVec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}
