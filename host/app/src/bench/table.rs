//! Rows and targets as lines for people.

use cauldron_fluid::{
    bench::{
        Group, Param, Row,
        target::{Target, verdicts},
    },
    simd::SimdClass,
};

/// What a row is of.
pub fn name(group: &Group, row: &Row) -> String {
    let [step, called] = group.step;
    let step = row.number(step).map_or(String::new(), |step| format!(" {called} {step}"));
    format!("{} {} n={}{step} {}", row.case, row.method, row.n.unwrap_or(0), row.quantity)
}

/// A head, and a line for each row.
pub fn rows(group: &Group, rows: &[Row]) -> Vec<String> {
    let head = format!(
        "{:<18} {:<20} {:>3} {:>5} {:>5} {:<17} {:<22} {:>9} {:>8} {:>4} {:>9} {:>10}",
        "case",
        "method",
        "n",
        group.step[1],
        "steps",
        group.word,
        "quantity",
        "value",
        "target",
        "",
        "ms/step",
        "founding"
    );
    std::iter::once(head).chain(rows.iter().map(|row| line(group, row))).collect()
}

fn line(group: &Group, row: &Row) -> String {
    let number = |name| row.number(name).map_or(String::new(), |value| value.to_string());
    let word = match row.params.get(group.word) {
        Some(Param::Word(word)) => word,
        _ => "",
    };
    let target = row.target.map_or(String::new(), |target| format!("{target:.2e}"));
    let pass = row.pass.map_or("", |pass| if pass { "ok" } else { "MISS" });
    let ms = row.ms.map_or(String::new(), |ms| format!("{ms:.3}"));
    let ratio = row.ratio_to_founding.map_or(String::new(), part);
    format!(
        "{:<18} {:<20} {:>3} {:>5} {:>5} {word:<17} {:<22} {:>9.2e} {target:>8} {pass:>4} \
         {ms:>9} {ratio:>10}",
        row.case,
        row.method,
        row.n.unwrap_or(0),
        number(group.step[0]),
        number("steps"),
        row.quantity,
        row.value,
    )
}

/// 1/4.0 for .25.
fn part(ratio: f64) -> String {
    if ratio < 1.0 { format!("1/{:.1}", 1.0 / ratio) } else { format!("{ratio:.1}") }
}

/// A line for each target of the cases that were run: what was measured, and whether that will do.
pub fn targets(group: &Group, rows: &[Row]) -> Vec<String> {
    let simd = rows.iter().find_map(|row| row.simd).and_then(SimdClass::parse);
    let simd = simd.unwrap_or(SimdClass::Portable);
    let head = [String::new(), format!("targets with {}", simd.name())];
    let is_asked = |target: &Target| rows.iter().any(|row| row.case == target.case);
    let asked_for =
        verdicts(group.targets, rows).into_iter().filter(|verdict| is_asked(verdict.target));
    let lines = asked_for.map(|verdict| {
        let mark = match verdict.row.and_then(|row| row.pass) {
            Some(true) => "\u{2713}   ",
            Some(false) => "MISS",
            None => "-   ",
        };
        let came = verdict.row.map_or("not in this run".to_owned(), measured);
        format!("{mark} {:<76} {came}", asked(verdict.target, simd))
    });
    head.into_iter().chain(lines).collect()
}

fn asked(target: &Target, simd: SimdClass) -> String {
    let n = target.n.map_or(String::new(), |n| format!(" n={n}"));
    let cfl = target.cfl.map_or(String::new(), |cfl| format!(" CFL {cfl}"));
    let time = target
        .ratio(simd)
        .map_or(String::new(), |ratio| format!(" in {} of the time", part(ratio)));
    let Target { case, method, quantity, at_most, .. } = target;
    format!("{case} {method}{n}{cfl}: {quantity} <= {at_most:.2e}{time}")
}

fn measured(row: &Row) -> String {
    let pair = row.ratio_to_founding.filter(|_| row.number("ratio_target").is_some());
    let time = pair.map_or(String::new(), |ratio| format!(" in {}", part(ratio)));
    format!("{:.2e}{time}", row.value)
}
