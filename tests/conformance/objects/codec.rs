// SPDX-License-Identifier: BSD-3-Clause
//! Encodes and decodes numbers of the spec random.ul:  `e INDEX NUMBER` gives the raw number or `-`, `d INDEX RAW` the
//! value.
#![forbid(unsafe_code)]

use std::io::{stdin, BufRead};

use random::unitylink::{Facts, Kind, Result, Value};
use random::Random;

fn encode(facts: &Facts, number: &str) -> Result<u64> {
    match facts.kind {
        Kind::Signed => number.parse::<i64>().unwrap().encode(facts),
        Kind::Unsigned => number.parse::<u64>().unwrap().encode(facts),
        _ => number.parse::<f64>().unwrap().encode(facts),
    }
}

fn decode(facts: &Facts, raw: u64) -> String {
    match facts.kind {
        Kind::Signed => i64::decode(facts, raw).unwrap().to_string(),
        Kind::Unsigned => u64::decode(facts, raw).unwrap().to_string(),
        _ => format!("{:e}", f64::decode(facts, raw).unwrap()),
    }
}

fn main() {
    for line in stdin().lock().lines() {
        let line = line.expect("a line");
        let words: Vec<&str> = line.split(' ').collect();
        let facts = &Random::facts().values[words[1].parse::<usize>().unwrap()];
        let told = match words[0] {
            "d" => decode(facts, words[2].parse().unwrap()),
            _ => encode(facts, words[2]).map_or("-".to_string(), |raw| raw.to_string()),
        };
        println!("{told}");
    }
}
