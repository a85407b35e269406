//! The papers' figures: scenes of `scenes/`, each with its caption.

use crate::error::Result;
use crate::image::ImageSize;
use crate::scene::Scene;

/// A figure of a paper, as a scene in TOML that begins with its caption.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Figure {
    /// What its file is called, such as `figure-07`, or `2010-figure-08` where the paper is not that of 2015.
    pub name: &'static str,
    /// The scene, which names no file.
    pub text: &'static str,
}

macro_rules! figures {
    ($($name:literal),*) => {
        &[$(Figure {
            name: $name,
            text: include_str!(concat!("../../scenes/", $name, ".toml")),
        }),*]
    };
}

impl Figure {
    /// All figures: those of 2015, 2010, 2008, 2006 and 2013.
    pub const ALL: &[Self] = figures!(
        "figure-07",
        "figure-08",
        "figure-09",
        "figure-10",
        "figure-11",
        "figure-12-left",
        "figure-12-right",
        "figure-14",
        "figure-15",
        "figure-16",
        "figure-17",
        "2010-figure-08",
        "2010-figure-09",
        "2010-figure-10",
        "2010-figure-11",
        "2010-figure-12",
        "2010-figure-13",
        "2010-figure-14",
        "2010-figure-15",
        "2010-figure-15-without",
        "2010-figure-16",
        "2010-figure-16-without",
        "2010-figure-17",
        "2010-figure-17-without",
        "2010-figure-18",
        "2010-figure-18-without",
        "2008-figure-08-a",
        "2008-figure-08-b",
        "2008-figure-09-4096",
        "2008-figure-09-16384",
        "2008-figure-09-65536",
        "2008-figure-10-a",
        "2008-figure-10-b",
        "2008-figure-10-c",
        "2008-figure-10-d",
        "2008-figure-11-a",
        "2008-figure-11-b",
        "2008-figure-11-c",
        "2008-figure-11-d",
        "2008-figure-12-16",
        "2008-figure-12-32",
        "2008-figure-12-52",
        "2006-figure-2-1",
        "2006-figure-2-2",
        "2006-figure-2-3",
        "2006-figure-5-1",
        "2006-figure-5-3-20",
        "2006-figure-5-3-40",
        "2006-figure-5-3-60",
        "2013-figure-4-1",
        "2013-figure-4-2-left",
        "2013-figure-4-2-right",
        "2013-figure-4-3-left",
        "2013-figure-4-3-right",
        "2013-figure-4-4-left",
        "2013-figure-4-4-right",
        "2013-figure-4-5-left",
        "2013-figure-4-5-right",
        "2013-figure-4-6-left",
        "2013-figure-4-6-right",
        "2013-figure-4-7",
        "2013-figure-4-8"
    );

    /// Says what it shows: the comment that its scene begins with, in a line.
    #[must_use]
    pub fn caption(&self) -> String {
        let lines = self.text.lines().map_while(|line| line.strip_prefix('#'));
        lines.map(str::trim).collect::<Vec<_>>().join(" ")
    }

    /// Makes its scene, of its own size without one.
    ///
    /// # Errors
    /// None for sizes that an image can have.
    pub fn scene(&self, size: Option<ImageSize>) -> Result<Scene> {
        Scene::from_reader_with(self.text.as_bytes(), self.name, |scene, _| {
            scene.image = size.unwrap_or(scene.image);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_figure_of_the_repository_is_here_and_is_its_file() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let mut names: Vec<String> = std::fs::read_dir(&scenes)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.contains("figure-") && name.ends_with(".toml"))
            .collect();
        let mut found: Vec<String> = Figure::ALL
            .iter()
            .map(|figure| format!("{}.toml", figure.name))
            .collect();
        names.sort();
        found.sort();
        assert_eq!(found, names);
        for figure in Figure::ALL {
            let path = scenes.join(format!("{}.toml", figure.name));
            let (scene, file) = (
                figure.scene(None).unwrap(),
                Scene::from_file(&path).unwrap(),
            );
            assert_eq!((scene.image, &scene.display), (file.image, &file.display));
            assert_eq!(scene.meshes, file.meshes);
            assert!(
                figure.caption().starts_with("Figure"),
                "{}",
                figure.caption()
            );
        }
    }

    #[test]
    fn a_figure_has_other_sizes_and_a_caption_in_one_line() {
        let named = |name| Figure::ALL.iter().find(|it| it.name == name).unwrap();
        let size = ImageSize {
            width: 40,
            height: 30,
        };
        let scene = named("2010-figure-16").scene(Some(size)).unwrap();
        assert_eq!((scene.image, scene.meshes.len()), (size, 2));
        assert_eq!(
            named("figure-14").caption(),
            "Figure 14 of Watanabe, Abe, Konno 2015: a torus, t = 8.0, for several numbers of divisions (--divisions). \
             R is not given there."
        );
    }
}
