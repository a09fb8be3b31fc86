//! The programs of README and book: `cargo test -p book` compiles them all, and runs them. Paths in them are seen from
//! `docs`.

/// The front page of the repository.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(doctest)]
#[doc = include_str!("src/ahqp-core.md")]
struct AhqpCore;

#[cfg(doctest)]
#[doc = include_str!("src/contributing.md")]
struct Contributing;

#[cfg(doctest)]
#[doc = include_str!("src/moca-model.md")]
struct MocaModel;

#[cfg(doctest)]
#[doc = include_str!("src/moca-model-robot.md")]
struct MocaModelRobot;

#[cfg(doctest)]
#[doc = include_str!("src/real-robot.md")]
struct RealRobot;

#[cfg(doctest)]
#[doc = include_str!("src/vision-networks.md")]
struct VisionNetworks;

#[cfg(doctest)]
#[doc = include_str!("src/vision-poses.md")]
struct VisionPoses;

#[cfg(doctest)]
#[doc = include_str!("src/whole-body-tasks.md")]
struct WholeBodyTasks;

#[cfg(doctest)]
#[doc = include_str!("src/whole-body-torques.md")]
struct WholeBodyTorques;

#[cfg(doctest)]
#[doc = include_str!("src/whole-body.md")]
struct WholeBody;

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    /// Returns the statements of a program, without comments and white space.
    fn statements(program: &str) -> Vec<String> {
        let lines = program.lines().map(|line| {
            line.split(" // ").next().unwrap().split("  # ").next().unwrap().trim().to_owned()
        });
        lines.filter(|line| line.len() > 2).collect()
    }

    #[test]
    fn readme_shows_the_example_of_both_languages() {
        let readme = include_str!("../README.md");
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../moca-model");
        for (language, file) in [
            ("```rust", "whole-body/examples/panda_circle.rs"),
            ("```python", "python/examples/panda_circle.py"),
        ] {
            let example = fs::read_to_string(root.join(file)).unwrap();
            let shown = readme.split(language).nth(1).unwrap().split("```").next().unwrap();
            let control = shown.split("start =").nth(1).unwrap().lines().skip(1);
            for statement in statements(&control.collect::<Vec<_>>().join("\n")) {
                assert!(
                    statement == "Ok(())" || example.contains(&statement),
                    "{file}: {statement}"
                );
            }
        }
    }

    #[test]
    fn every_page_with_a_program_is_compiled() {
        let listed = include_str!("programs.rs");
        let pages = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut count = 0;
        for page in fs::read_dir(pages).unwrap() {
            let path = page.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            if !path.is_file() || !fs::read_to_string(&path).unwrap().contains("```rust") {
                continue;
            }
            count += 1;
            assert!(listed.contains(&format!("\"src/{name}\"")), "{name} is not in programs.rs");
        }
        assert!(count > 5, "{count} pages");
    }
}
