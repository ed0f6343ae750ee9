use super::*;
use crate::accuracy::change::SceneChange;
use crate::sequence::quality::{Integrator, NoiseTarget, PathSettings, Quality};

fn facts(random: bool, samples: f64) -> SceneFacts {
    SceneFacts { random, other_random: !random, samples, error: 0.03, bright: 2.0 }
}

fn scopes() -> [Scope; 2] {
    [true, false].map(|quick| Scope { quick, most: None })
}

fn path(samples: u32) -> Quality {
    Quality { integrator: Integrator::Path(PathSettings::default()), samples, ..Quality::default() }
}

#[test]
fn the_own_setting_comes_first_and_once() {
    for (own, random) in [(Quality::default(), false), (Quality::default(), true), (path(64), true)] {
        for scope in scopes() {
            let samples = samples_of(&own, random, 64.0);
            let settings = Experiment::new(&own, facts(random, samples), scope);
            assert_eq!(settings.all[0].quality, own);
            let curve = settings.all.iter().filter(|setting| !setting.axis.has_baseline());
            assert_eq!(curve.filter(|setting| setting.quality == own).count(), 1);
        }
    }
}

#[test]
fn references_have_sixteen_times_the_samples_of_settings() {
    let noise = |error| Quality { noise: Some(NoiseTarget { error, most: 4096 }), ..path(64) };
    let cases = [(path(64), 64.0), (path(512), 512.0), (path(1), 1.0), (noise(0.05), 300.0)];
    for (own, samples) in cases {
        for scope in scopes() {
            let settings = Experiment::new(&own, facts(true, samples), scope);
            let curve = settings.all.iter().skip(1).filter(|setting| !setting.axis.has_baseline());
            let most = curve
                .map(|setting| setting.samples.max(f64::from(setting.quality.noise.map_or(0, |n| n.most))));
            let most = most.fold(samples, f64::max);
            assert!(2.0 * f64::from(settings.reference) >= 16.0 * most, "{samples} {scope:?}: {most}");
        }
    }
}

#[test]
fn the_curve_has_every_factor_of_two_around_the_own_setting() {
    for own in [1, 3, 64, 100, 512] {
        for scope in scopes() {
            let settings = Experiment::new(&path(own), facts(true, own.into()), scope);
            let on = settings.all.iter().filter(|setting| setting.axis == SettingAxis::Samples);
            let mut samples: Vec<f64> = on.map(|setting| setting.samples).collect();
            samples.sort_by(f64::total_cmp);
            assert!(samples.contains(&f64::from(2 * own)), "double of {own}: {samples:?}");
            assert!(own == 1 || samples.contains(&f64::from(own / 2)), "half of {own}: {samples:?}");
            assert!(samples.windows(2).all(|pair| pair[1] / pair[0] <= 3.0), "{samples:?}");
        }
    }
}

#[test]
fn short_settings_are_compared_at_equal_samples() {
    let own = path(512);
    let mut settings = Experiment::new(&own, facts(true, 512.0), Scope { quick: true, most: None });
    settings.parts(&own, vec![(SceneChange::LightOff(0), "a light".to_owned())]);
    settings.remedies(&own, true, true);
    let short = |setting: &Setting| setting.axis.has_baseline() && setting.axis != SettingAxis::Integrator;
    for (index, setting) in settings.all.iter().enumerate().filter(|(_, setting)| short(setting)) {
        let baseline = &settings.all[settings.baseline(index)];
        assert_eq!(
            (baseline.samples, baseline.runs, baseline.change),
            (setting.samples, setting.runs, SceneChange::None)
        );
        assert_eq!(baseline.quality.bounces, own.bounces);
    }
    let remedies = settings.all.iter().filter(|setting| setting.axis == SettingAxis::Remedies);
    let names: Vec<_> = remedies.map(|setting| setting.value.as_str()).collect();
    assert_eq!(names[1..4], ["clamp: 50", "clamp: 10", "refractive_shadows: true"]);
}

#[test]
fn omitted_settings_have_a_reason() {
    let left_out = |random| {
        let settings =
            Experiment::new(&Quality::default(), facts(random, 64.0), Scope { quick: false, most: None });
        settings.left_out.iter().map(|left| left.what).collect::<Vec<_>>()
    };
    assert!(left_out(false).contains(&"samples") && !left_out(false).contains(&"anti-aliasing grid"));
    assert!(left_out(true).contains(&"anti-aliasing grid") && !left_out(true).contains(&"samples"));
    assert!(left_out(true).contains(&"roulette"));
}
