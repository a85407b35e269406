//! Which channel of an OpenEXR file holds the depths: the one that is asked for, else the one whose name says so.
//!
//! Renderers put the name of a view layer or a pass before a channel's own (`ViewLayer.Depth.Z`), or give each pass a
//! part. What stands beside depths has names like theirs: normals and positions have a Z, colours an R.

use super::openexr::ChannelName;
use crate::shown::shown;

/// How the channel of the depths was found.
#[derive(Debug, PartialEq)]
pub(super) enum Choice<'a> {
    /// It was asked for, is called `Z`, or is alone.
    Sure(&'a ChannelName),
    /// Its name, or its layer's, says depth; there are others.
    Guess(&'a ChannelName),
    /// Red, green and blue, which are depths only if they are equal everywhere.
    IfEqual([&'a ChannelName; 3]),
}

/// How a name says depth; the first is the surest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    /// `Z`, in no layer.
    Exact,
    /// A layer, part or channel is called depth.
    Called,
    /// One has depth in its name.
    Within,
    /// The Z of a layer that says nothing.
    OnlyZ,
}

/// Finds the channel of this exact name, which may begin with its part's.
pub(super) fn named<'a>(all: &'a [ChannelName], wanted: &str) -> Result<&'a ChannelName, String> {
    let plain: Vec<_> = all.iter().filter(|c| c.name == wanted).collect();
    let full: Vec<_> = all.iter().filter(|c| c.full() == wanted).collect();
    match (plain.as_slice(), full.as_slice()) {
        ([one], _) | (_, [one]) => Ok(one),
        ([], _) => Err(format!("no channel {}; {}", quoted(wanted), listed(all))),
        _ => Err(format!(
            "channel {} is in several parts; write the part before it, as listed; {}",
            quoted(wanted),
            listed(all)
        )),
    }
}

/// Finds the channel by what the names say.
pub(super) fn choose(all: &[ChannelName]) -> Result<Choice<'_>, String> {
    let passes = passes(all);
    let found: Vec<_> = passes.iter().filter_map(Pass::candidate).collect();
    let colours = || all.iter().filter(|channel| !is_alpha(channel));
    if let Some(best) = found.iter().map(|(rank, _)| *rank).min() {
        let mut of_best = found.into_iter().filter(|(rank, _)| *rank == best);
        return match (of_best.next(), of_best.next()) {
            (Some((rank, Choice::Guess(one))), None) => {
                let is_sure = rank == Rank::Exact || colours().count() == 1;
                Ok(if is_sure {
                    Choice::Sure(one)
                } else {
                    Choice::Guess(one)
                })
            }
            (Some((_, choice)), None) => Ok(choice),
            _ => Err(unclear("several channels may hold depths", all)),
        };
    }
    let nothing = || unclear("no channel's name says depth", all);
    let channels: Vec<_> = colours().collect();
    match channels.as_slice() {
        [one] if ["r", "v", "y", "distance"].contains(&one.base().as_str()) => {
            match says_other(one) {
                true => Err(nothing()),
                false => Ok(Choice::Sure(one)),
            }
        }
        [_, _, _] if passes.len() == 1 => match passes[0].rgb() {
            Some(rgb) if !says_other(rgb[0]) => Ok(Choice::IfEqual(rgb)),
            _ => Err(nothing()),
        },
        _ => Err(nothing()),
    }
}

/// The channels of a part that share all of their name but its end.
struct Pass<'a> {
    channels: Vec<&'a ChannelName>,
}

fn passes(all: &[ChannelName]) -> Vec<Pass<'_>> {
    let mut passes: Vec<Pass<'_>> = Vec::new();
    for channel in all {
        let is_of = |pass: &&mut Pass<'_>| {
            let first = pass.channels[0];
            first.id.part == channel.id.part && first.layer() == channel.layer()
        };
        match passes.iter_mut().find(is_of) {
            Some(pass) => pass.channels.push(channel),
            None => passes.push(Pass {
                channels: vec![channel],
            }),
        }
    }
    passes
}

impl<'a> Pass<'a> {
    fn get(&self, base: &str) -> Option<&'a ChannelName> {
        self.channels.iter().copied().find(|c| c.base() == base)
    }

    fn rgb(&self) -> Option<[&'a ChannelName; 3]> {
        let of = |short: &str, long: &str| self.get(short).or_else(|| self.get(long));
        Some([of("r", "red")?, of("g", "green")?, of("b", "blue")?])
    }

    /// Returns what may be depths here.
    fn candidate(&self) -> Option<(Rank, Choice<'a>)> {
        let said_by = |channel: &ChannelName| rank_of(&channel.base());
        let own = self
            .channels
            .iter()
            .filter(|c| c.base() != "z" && !says_other(c));
        if let Some((rank, channel)) = own
            .filter_map(|channel| Some((said_by(channel)?, *channel)))
            .min_by_key(|(rank, _)| *rank)
        {
            return Some((rank, Choice::Guess(channel)));
        }
        let (first, z) = (self.channels[0], self.get("z"));
        // X, Y, Z: a vector, whose Z is no depth.
        if (self.get("x").is_some() && z.is_some()) || says_other(z.unwrap_or(first)) {
            return None;
        }
        let by_layer = first.path().filter_map(|word| rank_of(&word)).min();
        let rank = match (z, by_layer) {
            (Some(z), _) if z.name == "Z" => Rank::Exact,
            (Some(_), None) => Rank::OnlyZ,
            (_, by_layer) => by_layer?,
        };
        if let Some(channel) = z.or_else(|| self.get("v")).or_else(|| self.get("y")) {
            return Some((rank, Choice::Guess(channel)));
        }
        let colours: Vec<_> = self.channels.iter().filter(|c| !is_alpha(c)).collect();
        match (colours.as_slice(), self.rgb()) {
            ([one], _) => Some((rank, Choice::Guess(one))),
            ([_, _, _], Some(rgb)) => Some((rank, Choice::IfEqual(rgb))),
            _ => None,
        }
    }
}

impl ChannelName {
    /// Returns the name with the part's before it.
    pub(super) fn full(&self) -> String {
        match self.part.as_str() {
            "" => self.name.clone(),
            part => format!("{part}.{}", self.name),
        }
    }

    /// Returns all of the name but its end.
    fn layer(&self) -> &str {
        self.name.rsplit_once('.').map_or("", |(layer, _)| layer)
    }

    /// Returns the end of the name, in lower case.
    fn base(&self) -> String {
        let base = self.name.rsplit('.').next().unwrap_or(&self.name);
        base.to_lowercase()
    }

    /// Returns the names of part and layers, in lower case.
    fn path(&self) -> impl Iterator<Item = String> {
        let words = self.part.split('.').chain(self.layer().split('.'));
        words.map(str::to_lowercase)
    }
}

/// Returns how a word, in lower case, says depth.
fn rank_of(word: &str) -> Option<Rank> {
    const CALLED: [&str; 7] = [
        "depth",
        "z",
        "zdepth",
        "depthz",
        "zpass",
        "depthpass",
        "vrayzdepth",
    ];
    let letters: String = word.chars().filter(|c| c.is_alphabetic()).collect();
    if CALLED.contains(&letters.as_str()) {
        return Some(Rank::Called);
    }
    let is_within = letters.contains("depth") || letters.contains("zbuf");
    is_within.then_some(Rank::Within)
}

/// Returns whether a channel's part, layers or name say that it is something else: normals, positions, motion, mist.
fn says_other(channel: &ChannelName) -> bool {
    const WORDS: [&str; 22] = [
        "n", "nn", "ng", "ns", "norm", "norms", "p", "pp", "pos", "pworld", "pref", "vec", "vel",
        "mv", "uv", "uvw", "st", "tangent", "mist", "fog", "zback", "back",
    ];
    const WITHIN: [&str; 12] = [
        "normal",
        "position",
        "vector",
        "velocity",
        "motion",
        "crypto",
        "world",
        "field",
        "mask",
        "matte",
        "invers",
        "disparity",
    ];
    channel.path().chain([channel.base()]).any(|name| {
        let mut words = name.split(|c: char| !c.is_alphabetic());
        words.any(|word| WORDS.contains(&word) || WITHIN.iter().any(|part| word.contains(part)))
    })
}

fn is_alpha(channel: &ChannelName) -> bool {
    ["a", "alpha"].contains(&channel.base().as_str())
}

fn unclear(why: &str, all: &[ChannelName]) -> String {
    format!(
        "{why}: name the right one as the depth's `channel`; {}",
        listed(all)
    )
}

/// Lists all channels; of many the first.
pub(super) fn listed(all: &[ChannelName]) -> String {
    const SHOWN: usize = 40;
    let names: Vec<String> = all.iter().take(SHOWN).map(|c| shown(&c.full())).collect();
    let rest = match all.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("channels: {}{rest}", names.join(", "))
}

fn quoted(name: &str) -> String {
    format!("`{}`", shown(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::openexr::ChannelId;

    /// Channels as `part: name name; part: name`.
    fn channels(text: &str) -> Vec<ChannelName> {
        let of_part = |(part, text): (usize, &str)| {
            let (name, channels) = text.split_once(": ").unwrap_or(("", text));
            let name = name.trim().to_owned();
            let make = move |(channel, text): (usize, &str)| ChannelName {
                id: ChannelId::new(part, channel),
                part: name.clone(),
                name: text.replace('_', " "),
            };
            channels
                .split_whitespace()
                .enumerate()
                .map(make)
                .collect::<Vec<_>>()
        };
        text.split(';').enumerate().flat_map(of_part).collect()
    }

    /// What is chosen: a channel, `=` before red if only where the colours are equal, or nothing.
    fn chosen(text: &str) -> Option<String> {
        match choose(&channels(text)) {
            Ok(Choice::Sure(one)) => Some(format!("!{}", one.full())),
            Ok(Choice::Guess(one)) => Some(one.full()),
            Ok(Choice::IfEqual([red, ..])) => Some(format!("={}", red.full())),
            Err(reason) => {
                assert!(reason.contains("channels: "), "{reason}");
                None
            }
        }
    }

    #[test]
    fn names_that_say_depth_win_and_what_is_unclear_is_refused() {
        for (names, expected) in [
            ("Z", "!Z"),
            ("B G N.X N.Y N.Z R Z", "!Z"),
            ("Depth.V Z", "!Z"),
            ("A B G R ZDepth", "ZDepth"),
            ("A B G R zdepth.R", "zdepth.R"),
            ("X Y Z ZDepth", "ZDepth"),
            (
                "Depth.V Image.A Image.B Image.G Image.R Normal.X Normal.Y Normal.Z",
                "Depth.V",
            ),
            ("B G R ZDepth.V normals.X normals.Y normals.Z", "ZDepth.V"),
            ("B G R Z-Depth.B Z-Depth.G Z-Depth.R", "=Z-Depth.R"),
            ("A B G R Z_Depth.R", "Z Depth.R"),
            (
                "ViewLayer.Combined.R ViewLayer.Depth.Z ViewLayer.Mist.Z",
                "ViewLayer.Depth.Z",
            ),
            (
                "ViewLayer.Depth.Z ViewLayer.Denoising_Depth.Z",
                "ViewLayer.Depth.Z",
            ),
            (
                "RenderLayer.Combined.B RenderLayer.Depth.V",
                "RenderLayer.Depth.V",
            ),
            ("R G B VRayZDepth.R VRayZDepth.A", "VRayZDepth.R"),
            ("R G B depth_filtered.y", "depth filtered.y"),
            ("R G B beauty.Z", "beauty.Z"),
            ("rgba: A B G R; N: X Y Z; depth: Z", "!depth.Z"),
            ("rgba: A B G R; depth: R G B A", "=depth.R"),
            ("left: R G B; left.depth: V", "left.depth.V"),
            ("depth: R", "!depth.R"),
            ("R", "!R"),
            ("A Y", "!Y"),
            ("distance", "!distance"),
            ("A B G R", "=R"),
            ("Depth.V Depth.A", "!Depth.V"),
            ("R G B depth.X", "depth.X"),
            ("R G B z", "z"),
            ("rgba.red rgba.green rgba.blue depth.Z forward.u", "depth.Z"),
        ] {
            assert_eq!(chosen(names).as_deref(), Some(expected), "{names}");
        }
        for names in [
            "B G R dd.y nn.X nn.Y nn.Z",
            "N.X N.Y N.Z",
            "X Y Z",
            "N.Z",
            "normals.Z R G B",
            "ViewLayer.Mist.Z ViewLayer.Combined.R",
            "P.Z",
            "position.z",
            "R G B Depth.X Depth.Y Depth.Z",
            "R G B left.depth.Z right.depth.Z",
            "left: R Z; right: R Z",
            "R G",
            "A",
            "a b",
            "Y R",
            "R G B A foreground.R foreground.G foreground.B",
            "motion.R",
            "R G DepthOfField.R",
            "R G depth_mask.R",
            "R G B inverse_depth.V",
            "Depth.R Depth.G",
        ] {
            assert_eq!(chosen(names), None, "{names}");
        }
    }

    #[test]
    fn a_name_is_asked_for_exactly_and_may_begin_with_its_part() {
        let parts = channels("rgba: R Z; depth: Z; aux: depth.Q");
        let find = |name: &str| named(&parts, name).map(ChannelName::full);
        assert_eq!(find("depth.Z").unwrap(), "depth.Z");
        assert_eq!(find("rgba.R").unwrap(), "rgba.R");
        assert_eq!(find("R").unwrap(), "rgba.R");
        assert_eq!(find("depth.Q").unwrap(), "aux.depth.Q");
        assert!(find("Z").unwrap_err().contains("several parts"));
        let missing = find("r\u{1b}[31m").unwrap_err();
        assert!(
            missing.contains("no channel `r\\u{1b}[31m`; channels: rgba.R, "),
            "{missing}"
        );
    }

    #[test]
    fn lists_are_short() {
        let many: Vec<String> = (0..1000).map(|number| format!("c{number}")).collect();
        let text = listed(&channels(&many.join(" ")));
        assert!(
            text.ends_with("c39 and 960 more") && text.len() < 300,
            "{text}"
        );
    }
}
