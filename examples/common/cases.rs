//! What the coverage of intervals is measured on: Genz' six families and the stiff set, with every method.

use estimand::Error;

use crate::integrands::{Family, Problem};
use crate::methods::Method;
use crate::stiff;
use crate::trial::{Subject, Trial};

/// The name of an integrand, and one method on it.
pub(crate) struct Row {
    pub(crate) integrand: String,
    pub(crate) trial: Trial,
}

/// How much is done, and what is told about it.
pub(crate) struct Plan<'a> {
    /// Evaluations of a run.
    pub(crate) count: u64,
    /// Runs of each method on each integrand.
    pub(crate) runs: u64,
    /// Only the rows whose integrand and method contain this.
    pub(crate) only: &'a str,
    /// Called with the name of each integrand.
    pub(crate) begin: &'a dyn Fn(&str),
}

impl Plan<'_> {
    fn rows(
        &self,
        name: &str,
        subject: &Subject<'_, impl estimand::Integrand<Value = f64>>,
    ) -> Result<Vec<Row>, Error> {
        (self.begin)(name);
        let mut rows = Vec::new();
        for method in Method::ALL {
            if !format!("{name}, {}", method.name()).contains(self.only) {
                continue;
            }
            let trial = Trial::new(method, subject, self.count, self.runs, 1000)?;
            rows.extend(trial.map(|trial| Row {
                integrand: name.to_owned(),
                trial,
            }));
        }
        Ok(rows)
    }

    /// Genz' families in 2, 5 and 10 dimensions.
    pub(crate) fn genz(&self) -> Result<Vec<Row>, Error> {
        const FAMILIES: [Family; 6] = [
            Family::Oscillatory,
            Family::ProductPeak,
            Family::CornerPeak,
            Family::Gaussian,
            Family::Continuous,
            Family::Discontinuous,
        ];
        let mut rows = Vec::new();
        for family in FAMILIES {
            for dims in [2, 5, 10] {
                let problem = Problem::new(family, dims);
                let subject = Subject {
                    integrand: &problem,
                    integral: problem.integral().expect("in closed form"),
                    bounds: match family {
                        Family::Oscillatory => Some([-1.0, 1.0]),
                        Family::CornerPeak | Family::Gaussian | Family::Continuous => {
                            Some([0.0, 1.0])
                        }
                        _ => None,
                    },
                };
                rows.extend(self.rows(&format!("{family}, d = {dims}"), &subject)?);
            }
        }
        Ok(rows)
    }

    /// The stiff set in up to ten dimensions, indicators among it.
    pub(crate) fn stiff(&self) -> Result<Vec<Row>, Error> {
        let mut rows = Vec::new();
        for case in stiff::cases().iter().filter(|case| case.dims <= 10) {
            rows.extend(self.rows(&case.name, &case.into())?);
        }
        Ok(rows)
    }
}
