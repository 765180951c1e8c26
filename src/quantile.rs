//! Quantiles of the normal and of Student's distribution: the widths of intervals.

/// The quantile of the standard normal distribution at `p` in `(0, 1)`, to some 16 digits.[^wichura]
///
/// [^wichura]: Wichura, Michael (1988). *Algorithm AS 241: The Percentage Points of the Normal
///     Distribution*. <https://doi.org/10.2307/2347330>
#[expect(clippy::excessive_precision, reason = "as published")]
pub(crate) fn normal(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return q * ratio(
            r,
            [
                3.387_132_872_796_366_608_0,
                133.141_667_891_784_377_45,
                1_971.590_950_306_551_442_7,
                13_731.693_765_509_461_125,
                45_921.953_931_549_871_457,
                67_265.770_927_008_700_853,
                33_430.575_583_588_128_105,
                2_509.080_928_730_122_672_7,
            ],
            [
                1.0,
                42.313_330_701_600_911_252,
                687.187_007_492_057_908_30,
                5_394.196_021_424_751_107_7,
                21_213.794_301_586_595_867,
                39_307.895_800_092_710_610,
                28_729.085_735_721_942_674,
                5_226.495_278_852_854_561_0,
            ],
        );
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    let r = (-tail.ln()).sqrt();
    let x = if r <= 5.0 {
        ratio(
            r - 1.6,
            [
                1.423_437_110_749_683_577_34,
                4.630_337_846_156_545_295_90,
                5.769_497_221_460_691_405_50,
                3.647_848_324_763_204_605_04,
                1.270_458_252_452_368_382_58,
                0.241_780_725_177_450_611_770,
                0.022_723_844_989_269_184_583_3,
                7.745_450_142_783_414_076_40e-4,
            ],
            [
                1.0,
                2.053_191_626_637_758_821_87,
                1.676_384_830_183_803_849_40,
                0.689_767_334_985_100_004_550,
                0.148_103_976_427_480_074_590,
                0.015_198_666_563_616_457_196_6,
                5.475_938_084_995_344_946_00e-4,
                1.050_750_071_644_416_843_24e-9,
            ],
        )
    } else {
        ratio(
            r - 5.0,
            [
                6.657_904_643_501_103_777_20,
                5.463_784_911_164_114_369_90,
                1.784_826_539_917_291_335_80,
                0.296_560_571_828_504_891_230,
                0.026_532_189_526_576_123_093_0,
                1.242_660_947_388_078_438_60e-3,
                2.711_555_568_743_487_578_15e-5,
                2.010_334_399_292_288_132_65e-7,
            ],
            [
                1.0,
                0.599_832_206_555_887_937_690,
                0.136_929_880_922_735_805_310,
                0.014_875_361_290_850_614_852_5,
                7.868_691_311_456_132_591_00e-4,
                1.846_318_317_510_054_681_80e-5,
                1.421_511_758_316_445_888_70e-7,
                2.044_263_103_389_939_785_64e-15,
            ],
        )
    };
    x.copysign(q)
}

/// A ratio of two polynomials, the coefficients rising.
fn ratio(x: f64, above: [f64; 8], below: [f64; 8]) -> f64 {
    let value = |coefficients: [f64; 8]| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    value(above) / value(below)
}

/// The `t` with a probability of `level` between `-t` and `t` for Student's distribution with `freedom`
/// degrees of freedom, both above zero and `level` below 1.
pub(crate) fn student(level: f64, freedom: f64) -> f64 {
    // Past this the expansion in 1 / freedom is exact to twelve digits.
    const MANY: f64 = 1000.0;
    if freedom > MANY {
        let z = normal(0.5 + 0.5 * level);
        return expanded(z, freedom);
    }
    // Newton's steps towards the tail that is left outside, within a bracket that they narrow; where a step would leave it,
    // its middle.
    let half = 0.5 * freedom;
    let tail = 1.0 - level;
    let front =
        ln_gamma(half + 0.5) - ln_gamma(half) - 0.5 * (core::f64::consts::PI * freedom).ln();
    let (mut low, mut high) = (0.0, 1e150);
    let mut t = expanded(normal(0.5 + 0.5 * level), freedom.max(2.0));
    for _ in 0..200 {
        let excess = incomplete_beta(half, 0.5, freedom / (freedom + t * t)) - tail;
        if excess > 0.0 {
            low = t;
        } else {
            high = t;
        }
        let density = (front - (half + 0.5) * (t * t / freedom).ln_1p()).exp();
        let step = excess / (2.0 * density);
        let next = t + step;
        if next == t || high - low <= 1e-15 * high {
            break;
        }
        t = match () {
            () if next > low && next < high => next,
            // Far out quantiles differ by powers.
            () if high > 2.0 * low + 2.0 => (low.max(0.5) * high).sqrt(),
            () => 0.5 * (low + high),
        };
        if step.abs() < 1e-12 * t {
            break;
        }
    }
    t
}

/// Student's quantile from the normal one: formula 26.7.5 of Abramowitz and Stegun (1964), *Handbook of
/// Mathematical Functions*.
fn expanded(z: f64, freedom: f64) -> f64 {
    let q = z * z;
    let terms = [
        (q + 1.0) / 4.0,
        ((5.0 * q + 16.0) * q + 3.0) / 96.0,
        (((3.0 * q + 19.0) * q + 17.0) * q - 15.0) / 384.0,
        ((((79.0 * q + 776.0) * q + 1482.0) * q - 1920.0) * q - 945.0) / 92160.0,
    ];
    z + z * terms
        .iter()
        .rev()
        .fold(0.0, |sum, term| (sum + term) / freedom)
}

/// The regularised incomplete beta function `I_x(a, b)`, by its continued fraction.[^lentz]
///
/// [^lentz]: Lentz, William (1976). *Generating Bessel Functions in Mie Scattering Calculations Using
///     Continued Fractions*. <https://doi.org/10.1364/AO.15.000668>
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    const TINY: f64 = 1e-300;
    let away = |x: f64| if x.abs() < TINY { TINY } else { x };
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for m in 1..1000 {
        let m = f64::from(m);
        for coefficient in [
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        ] {
            d = 1.0 / away(1.0 + coefficient * d);
            c = away(1.0 + coefficient / c);
            fraction *= c * d;
        }
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    let front = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p();
    front.exp() * fraction / a
}

/// The logarithm of the gamma function for positive arguments, by Stirling's series past 15.
pub(crate) fn ln_gamma(x: f64) -> f64 {
    let mut x = x;
    let mut product = 1.0;
    while x < 15.0 {
        product *= x;
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series =
        (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r * (1.0 / 1680.0 - r / 1188.0)))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * core::f64::consts::TAU.ln() + series - product.ln()
}

/// The complementary error function for `x >= 0`: its Taylor series below 2, its continued fraction above.
pub(crate) fn erfc(x: f64) -> f64 {
    let square = x * x;
    let scale = (-square).exp() / core::f64::consts::PI.sqrt();
    if x < 2.0 {
        // erf(x) = 2 / sqrt(pi) exp(-x^2) sum of x (2 x^2)^n / (1 3 5 .. (2 n + 1))
        let (mut term, mut sum) = (x, x);
        for n in 1..60 {
            term *= 2.0 * square / f64::from(2 * n + 1);
            sum += term;
        }
        return 1.0 - 2.0 * scale * sum;
    }
    let fraction = (1..=60)
        .rev()
        .fold(x, |tail, n| x + 0.5 * f64::from(n) / tail);
    scale / fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    // The expected values are scipy 1.17's norm.ppf, t.ppf and gammaln.
    fn close(ours: f64, theirs: f64, tolerance: f64) {
        let error = (ours - theirs).abs();
        assert!(
            error <= tolerance * theirs.abs().max(1e-3),
            "{ours} against {theirs}"
        );
    }

    #[test]
    fn normal_quantiles() {
        for (p, theirs) in [
            (0.5, 0.0),
            (0.6, 0.253_347_103_135_799_7),
            (0.95, 1.644_853_626_951_472_2),
            (0.975, 1.959_963_984_540_054),
            (0.999_999, 4.753_424_308_817_087),
            (1e-10, -6.361_340_902_404_056),
            (1e-300, -37.047_096_299_361_2),
            (f64::EPSILON / 4.0, -8.292_361_075_813_597),
        ] {
            close(normal(p), theirs, 1e-14);
        }
    }

    #[test]
    fn student_quantiles() {
        for (level, freedom, theirs) in [
            (0.95, 1.0, 12.706_204_736_174_694),
            (0.95, 2.0, 4.302_652_729_749_462),
            (0.95, 7.0, 2.364_624_251_592_784),
            (0.99, 15.0, 2.946_712_883_475_238),
            (0.5, 3.5, 0.750_937_029_394_077_8),
            (0.1, 31.0, 0.126_695_016_275_336_9),
            (0.999_999, 4.0, 49.458_636_755_203_976),
            (0.99, 999.5, 2.580_757_166_429_153_3),
            (0.95, 1000.0, 1.962_339_080_826_408_3),
            (0.5, 0.3, 3.027_336_940_864_797_7),
            (0.95, 0.5, 164.557_673_480_488_2),
            (0.999, 2.5, 18.277_893_528_130_64),
            (0.95, 1001.0, 1.962_336_705_280_879_8),
            (0.95, 1e9, 1.959_963_986_912_325),
        ] {
            close(student(level, freedom), theirs, 1e-10);
        }
    }

    #[test]
    fn complementary_error_function() {
        // scipy 1.17's erfc.
        for (x, theirs) in [
            (0.0, 1.0),
            (0.5, 0.479_500_122_186_953_5),
            (1.9, 0.007_209_570_764_742_53),
            (2.0, 0.004_677_734_981_047_265),
            (5.0, 1.537_459_794_428_034_8e-12),
            (20.0, 5.395_865_611_607_901e-176),
        ] {
            let error = (erfc(x) / theirs - 1.0).abs();
            assert!(error < 1e-12, "erfc({x})");
        }
    }

    #[test]
    fn logarithms_of_gamma() {
        for (x, theirs) in [
            (0.5, 0.572_364_942_924_7),
            (1.5, -0.120_782_237_635_245_26),
            (10.0, 12.801_827_480_081_469),
            (100.5, 361.435_540_467_777_57),
            (1e-3, 6.907_178_885_383_853),
        ] {
            close(ln_gamma(x), theirs, 1e-13);
        }
    }
}
