//! Where the points of a surface end, when depth noise and sampling blur the end.
//!
//! The outermost of a thousand noisy points lies some three standard deviations beyond the surface, and more the more
//! points there are: taking it for the end makes every object too large. So the end is the maximum of a likelihood:
//! points are spread evenly up to the end (a surface seen from the side), or gathered at it (a face turned to the
//! camera), and both are blurred by what is known of the noise.

/// An end and how sure it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) position_m: f64,
    /// Standard deviation from the shape of the likelihood (m).
    pub(super) sigma_m: f64,
}

/// How the readings near an end are blurred.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blur {
    /// Standard deviation of the points along the coordinate (m).
    pub(super) noise_m: f64,
    /// Distance between samples along the coordinate on a surface seen from the side (m).
    pub(super) step_m: f64,
    /// Width of the band along an edge in which structured-light cameras lose readings (m).
    pub(super) band_m: f64,
}

/// How the points near an end are spread.
#[derive(Clone, Copy, Debug)]
struct Spread {
    /// Share on a face at the end.
    on_face: f64,
    /// Share of the readings that is left in the band along the edge.
    left_in_band: f64,
}

/// The most probable end of `coordinates` near `last_m`, where they become sparse; `extent_m` is how far they reach.
pub(super) fn end_of(coordinates: &[f64], last_m: f64, extent_m: f64, blur: Blur) -> End {
    // Samples lie anywhere between one step short of the end and the end.
    let sampling_m = blur.step_m / 12.0_f64.sqrt();
    let side_m = blur.noise_m.hypot(sampling_m).max(MIN_BLUR_M);
    let window = (WINDOW_SHARE * extent_m).max(WINDOW_BLURS * side_m).max(3.0 * blur.band_m);
    let bins = Bins::new(coordinates, last_m - window, last_m + 3.0 * side_m);
    let face_m = blur.noise_m.max(MIN_BLUR_M);
    let model = Model { bins, side_m, face_m, band_m: blur.band_m };
    let first = last_m - 0.75 * window;
    let reach = 0.75 * window + 1.5 * side_m + blur.band_m;
    let at = |i: usize, of: usize| first + reach * i as f64 / of as f64;
    let mut best = (f64::MIN, SPREADS[0]);
    for i in 0..=COARSE {
        let basis = model.basis(at(i, COARSE));
        for spread in SPREADS {
            let fit = model.log_likelihood(&basis, spread);
            if fit > best.0 {
                best = (fit, spread);
            }
        }
    }
    let mut profile = [0.0; FINE + 1];
    for (i, fit) in profile.iter_mut().enumerate() {
        *fit = model.log_likelihood(&model.basis(at(i, FINE)), best.1);
    }
    let (position_m, sigma_m) = moments(&profile, first, reach / FINE as f64);
    End { position_m, sigma_m }
}

/// Mean and standard deviation of the end under the likelihood.
fn moments(profile: &[f64], first: f64, step: f64) -> (f64, f64) {
    let best = profile.iter().copied().fold(f64::MIN, f64::max);
    // Neighbouring readings share steps of the disparity and what the outline leaves out.
    let weight = |fit: f64| (INDEPENDENT_SHARE * (fit - best)).exp();
    let (mut total, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for (i, fit) in profile.iter().enumerate() {
        let (w, at) = (weight(*fit), step * i as f64);
        total += w;
        sum += w * at;
        squares += w * at * at;
    }
    let mean = sum / total;
    (first + mean, (squares / total - mean * mean).max(0.0).sqrt().max(0.3 * step))
}

/// Counts of coordinates.
struct Bins {
    low: f64,
    width: f64,
    counts: [f64; BINS],
}

impl Bins {
    fn new(coordinates: &[f64], low: f64, high: f64) -> Self {
        let width = (high - low) / BINS as f64;
        let mut counts = [0.0; BINS];
        for c in coordinates.iter().filter(|c| **c > low && **c < high) {
            counts[(((c - low) / width) as usize).min(BINS - 1)] += 1.0;
        }
        Self { low, width, counts }
    }
}

/// What a hypothesis says of each bin: density of a face at the end, of a surface up to the band, and in the band.
type Basis = [[f64; 3]; BINS];

struct Model {
    bins: Bins,
    side_m: f64,
    face_m: f64,
    band_m: f64,
}

impl Model {
    fn basis(&self, end: f64) -> Basis {
        let length = end - self.bins.low;
        std::array::from_fn(|i| {
            if self.bins.counts[i] == 0.0 {
                return [0.0; 3];
            }
            let from_end = self.bins.low + (i as f64 + 0.5) * self.bins.width - end;
            let face = bell(from_end / self.face_m) / self.face_m;
            let before_band = below(-(from_end + self.band_m) / self.side_m);
            let in_band = below(-from_end / self.side_m) - before_band;
            [face, before_band / length, in_band.max(0.0) / length]
        })
    }

    fn log_likelihood(&self, basis: &Basis, spread: Spread) -> f64 {
        let everywhere = STRAY_SHARE / (self.bins.width * BINS as f64);
        // What the band loses, the rest has more of.
        let full = (1.0 - spread.on_face) / self.left(spread);
        let mut sum = 0.0;
        for (count, [face, side, band]) in self.bins.counts.iter().zip(basis) {
            if *count > 0.0 {
                let surface = side + spread.left_in_band * band;
                sum += count * (everywhere + full * surface + spread.on_face * face).ln();
            }
        }
        sum
    }

    /// Share of all readings that is left where the band along the edge loses some.
    fn left(&self, spread: Spread) -> f64 {
        let length = self.bins.width * BINS as f64 - 3.0 * self.side_m;
        1.0 - (1.0 - spread.left_in_band) * (self.band_m / length).min(0.5)
    }
}

/// The standard normal distribution function, to 1 % (Bowling et al. 2009).
fn below(x: f64) -> f64 {
    1.0 / (1.0 + (-1.702 * x).exp())
}

fn bell(x: f64) -> f64 {
    (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

const BINS: usize = 36;
const COARSE: usize = 16;
const FINE: usize = 36;
/// What is tried. Beside a jump of the depth a Kinect loses about half of the readings.
const SPREADS: [Spread; 7] = [
    Spread { on_face: 0.0, left_in_band: 1.0 },
    Spread { on_face: 0.2, left_in_band: 1.0 },
    Spread { on_face: 0.45, left_in_band: 1.0 },
    Spread { on_face: 0.7, left_in_band: 1.0 },
    Spread { on_face: 0.9, left_in_band: 1.0 },
    Spread { on_face: 0.0, left_in_band: 0.5 },
    Spread { on_face: 0.2, left_in_band: 0.5 },
];
/// Points in front and behind that are no part of the surface.
const STRAY_SHARE: f64 = 0.01;
/// How far from the end points are looked at, as a share of the object,
const WINDOW_SHARE: f64 = 0.12;
/// and at least in widths of the blur.
const WINDOW_BLURS: f64 = 6.0;
/// Readings are rounded to millimetres.
const MIN_BLUR_M: f64 = 0.001;
const INDEPENDENT_SHARE: f64 = 0.1;
