//! Measurements as data: JSON, or CSV (RFC 4180) with the same columns, the first line their names.

use std::fmt;
use std::io;
use std::time::SystemTime;

use clap::Args;
use energywave::Device;
use energywave::papers::Times;
use serde::Serialize;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::Value;

use super::{Failure, Outcome, print, print_json};

/// How measurements are printed; as text without.
#[derive(Debug, Args)]
pub struct DataArgument {
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Print CSV: a line for each measurement, the columns those of --json
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
}

impl DataArgument {
    pub fn is_text(&self) -> bool {
        !self.json && !self.csv
    }

    /// Prints a list of records of one kind, unless they are wanted as text.
    pub fn print<R: Serialize>(&self, records: &[R]) -> Outcome {
        match (self.json, self.csv) {
            (true, _) => print_json(&records),
            (_, true) => print_csv(records),
            _ => Ok(()),
        }
    }

    /// Prints a record; as JSON that is an object, no list.
    pub fn print_one<R: Serialize>(&self, record: &R) -> Outcome {
        match self.json {
            true => print_json(record),
            false => self.print(&[record]),
        }
    }
}

/// What measured, and when: the same in all records of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Origin {
    version: &'static str,
    driver: String,
    /// When the run began, UTC, as RFC 3339 has it.
    date: String,
}

impl Origin {
    pub fn now(devices: &[Device]) -> Self {
        let drivers: Vec<&str> = devices
            .iter()
            .map(|device| device.driver.as_str())
            .collect();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            driver: drivers.join(" + "),
            date: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
        }
    }
}

/// How often a frame was timed, and what that took, milliseconds.
#[derive(Debug, Serialize)]
pub struct Spread {
    pub repetitions: u32,
    pub median_ms: f64,
    pub least_ms: f64,
    pub greatest_ms: f64,
}

impl From<Times> for Spread {
    fn from(times: Times) -> Self {
        let [median_ms, least_ms, greatest_ms] =
            [times.median, times.least, times.greatest].map(|time| 1e3 * time.as_secs_f64());
        Self {
            repetitions: times.frames,
            median_ms,
            least_ms,
            greatest_ms,
        }
    }
}

fn print_csv<R: Serialize>(records: &[R]) -> Outcome {
    let text = csv(records).map_err(Failure::Stdout)?;
    print(&text)
}

fn csv<R: Serialize>(records: &[R]) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (number, record) in records.iter().enumerate() {
        let Fields(fields) = serde_json::from_str(&serde_json::to_string(record)?)?;
        if number == 0 {
            writer.write_record(fields.iter().map(|(name, _)| name))?;
        }
        writer.write_record(fields.iter().map(|(_, value)| cell(value)))?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    String::from_utf8(bytes).map_err(io::Error::other)
}

/// Returns a value as a cell has it: nothing where there is none, a list with spaces between.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(cell).collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    }
}

/// The fields of a record in their order.
struct Fields(Vec<(String, Value)>);

impl<'de> Deserialize<'de> for Fields {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Fields;

            fn expecting(&self, words: &mut fmt::Formatter) -> fmt::Result {
                words.write_str("a record")
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Fields, M::Error> {
                let mut fields = Vec::new();
                while let Some(field) = map.next_entry()? {
                    fields.push(field);
                }
                Ok(Fields(fields))
            }
        }
        reader.deserialize_map(InOrder)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // tests fail by panicking
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Row {
        name: &'static str,
        best: Option<f64>,
        at: (u32, u32),
        #[serde(flatten)]
        more: More,
    }

    #[derive(Serialize)]
    struct More {
        a: bool,
    }

    #[test]
    fn a_record_is_a_line_and_what_would_break_it_is_quoted() {
        let row = |name, best| Row {
            name,
            best,
            at: (3, 4),
            more: More { a: true },
        };
        let rows = [row("plain", Some(1e-3)), row("a,\"b\"\nc", None)];
        let expected = "name,best,at,a\nplain,0.001,3 4,true\n\"a,\"\"b\"\"\nc\",,3 4,true\n";
        assert_eq!(csv(&rows).unwrap(), expected);
        assert_eq!(csv::<Row>(&[]).unwrap(), "");
    }
}
