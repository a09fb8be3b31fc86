//! Classifies images with a ResNet, or with a linear SVM over its features.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use clap::{Parser, ValueEnum};
use examples::score_rows::print_likeliest;
use ndarray::{Array2, Axis};
use vision_models::{
    Checkpoint, ClassNames, ConfusionMatrix, LinearSvm, Loss, Options, Preprocessing, ResNet,
    ResNetDepth, SvmSettings, list_frames, read_image, softmax,
};

/// Classifies images: the five likeliest classes of each, by a ResNet or, as the paper classifies
/// surfaces, by a linear SVM over the features of its average pool.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// JPEG or PNG files.
    #[arg(required_unless_present_any = ["train", "test"])]
    images: Vec<PathBuf>,
    /// The ResNet's checkpoint, with torchvision's names.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// How many layers the ResNet has.
    #[arg(long, default_value = "50")]
    depth: Depth,
    /// The names of the network's classes, one a line.
    #[arg(long, value_name = "FILE", conflicts_with = "svm")]
    names: Option<PathBuf>,
    /// A linear SVM over the features, instead of the network's last layer.
    #[arg(long, value_name = "FILE")]
    svm: Option<PathBuf>,
    /// Train the SVM first, with the images of this folder, which has a folder for each class, and
    /// write it to the file of --svm.
    #[arg(long, value_name = "FOLDER", requires = "svm")]
    train: Option<PathBuf>,
    /// Classify the images of this folder, which has a folder for each class of the SVM, and print
    /// the confusion matrix in percent.
    #[arg(long, value_name = "FOLDER", requires = "svm")]
    test: Option<PathBuf>,
    /// Train with the hinge instead of the squared hinge.
    #[arg(long, requires = "train")]
    hinge: bool,
    /// The weight of the penalty against the margin.
    #[arg(long, default_value_t = 1.0, requires = "train")]
    cost: f64,
    /// Resize to 255 × 255, as the paper says, instead of the short side to 255.
    #[arg(long)]
    square: bool,
    /// Threads that share the work.
    #[arg(long, default_value_t = 1)]
    threads: usize,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Depth {
    #[value(name = "18")]
    Eighteen,
    #[value(name = "34")]
    ThirtyFour,
    #[value(name = "50")]
    Fifty,
    #[value(name = "101")]
    OneHundredOne,
    #[value(name = "152")]
    OneHundredFiftyTwo,
}

impl From<Depth> for ResNetDepth {
    fn from(depth: Depth) -> Self {
        match depth {
            Depth::Eighteen => Self::Eighteen,
            Depth::ThirtyFour => Self::ThirtyFour,
            Depth::Fifty => Self::Fifty,
            Depth::OneHundredOne => Self::OneHundredOne,
            Depth::OneHundredFiftyTwo => Self::OneHundredFiftyTwo,
        }
    }
}

/// What an image goes through.
struct Classifier {
    preprocessing: Preprocessing,
    network: ResNet,
}

impl Classifier {
    fn load(arguments: &Arguments) -> Result<Self> {
        ensure!(arguments.threads > 0, "--threads 0: give at least one");
        let preprocessing =
            if arguments.square { Preprocessing::SURFACE } else { Preprocessing::TORCHVISION };
        let options = Options { threads: arguments.threads, ..Options::default() };
        let side = preprocessing.crop;
        let weights = Checkpoint::open(&arguments.weights)
            .with_context(|| arguments.weights.display().to_string())?;
        let network = ResNet::load(arguments.depth.into(), weights, [side, side], options)?;
        Ok(Self { preprocessing, network })
    }

    /// The network's features and class scores of an image.
    fn see(&mut self, path: &Path) -> Result<(Vec<f32>, Vec<f32>)> {
        let image = self
            .preprocessing
            .image(read_image(path)?.view())
            .with_context(|| path.display().to_string())?;
        let scores = self.network.infer(image.view())?;
        Ok((scores.features.iter().copied().collect(), scores.logits.iter().copied().collect()))
    }

    /// The features of all images in the folders of these classes, and the class of each.
    fn see_folders(
        &mut self,
        folder: &Path,
        classes: &[String],
    ) -> Result<(Array2<f32>, Vec<usize>)> {
        let mut features = Vec::new();
        let mut labels = Vec::new();
        for (label, class) in classes.iter().enumerate() {
            let folder = folder.join(class);
            let images = list_frames(&folder).with_context(|| folder.display().to_string())?;
            for image in images {
                features.extend(self.see(&image)?.0);
                labels.push(label);
            }
        }
        let width = features.len() / labels.len().max(1);
        Ok((Array2::from_shape_vec((labels.len(), width), features)?, labels))
    }
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let mut classifier = Classifier::load(&arguments)?;
    let Some(file) = &arguments.svm else {
        return classify_by_network(&mut classifier, &arguments);
    };
    let svm = match &arguments.train {
        Some(folder) => {
            let svm = train(&mut classifier, folder, &arguments)?;
            fs::write(file, svm.to_string())
                .with_context(|| format!("cannot write {}", file.display()))?;
            svm
        }
        None => fs::read_to_string(file)
            .with_context(|| format!("cannot read {}", file.display()))?
            .parse()?,
    };
    if let Some(folder) = &arguments.test {
        test(&mut classifier, &svm, folder)?;
    }
    for path in &arguments.images {
        let (features, _) = classifier.see(path)?;
        let features = ndarray::aview1(&features);
        let class = svm.classify(features)?;
        let decisions = svm.decide(features)?;
        println!("{}: {} (f = {decisions:.3})", path.display(), svm.classes()[class]);
    }
    Ok(())
}

fn classify_by_network(classifier: &mut Classifier, arguments: &Arguments) -> Result<()> {
    let names = arguments.names.as_ref().map(ClassNames::read).transpose()?;
    for path in &arguments.images {
        let (_, logits) = classifier.see(path)?;
        println!("{}", path.display());
        print_likeliest(&softmax(&logits), names.as_ref())?;
    }
    Ok(())
}

fn train(classifier: &mut Classifier, folder: &Path, arguments: &Arguments) -> Result<LinearSvm> {
    let classes = list_classes(folder)?;
    let (features, labels) = classifier.see_folders(folder, &classes)?;
    let settings = SvmSettings {
        loss: if arguments.hinge { Loss::Hinge } else { Loss::SquaredHinge },
        cost: arguments.cost,
        ..SvmSettings::default()
    };
    let (svm, trainings) = LinearSvm::train(features.view(), &labels, classes, &settings)?;
    for training in trainings {
        ensure!(
            training.converged,
            "the training did not converge in {} steps: the objective is {}, at best {}",
            training.iterations,
            training.objective,
            training.bound
        );
        println!(
            "trained with {} images in {} steps: objective {:.6}",
            labels.len(),
            training.iterations,
            training.objective
        );
    }
    Ok(svm)
}

/// The folders in a folder, by name.
fn list_classes(folder: &Path) -> Result<Vec<String>> {
    let mut classes = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            match entry.file_name().into_string() {
                Ok(name) => classes.push(name),
                Err(name) => bail!("the folder {} is no class name", name.display()),
            }
        }
    }
    classes.sort();
    Ok(classes)
}

fn test(classifier: &mut Classifier, svm: &LinearSvm, folder: &Path) -> Result<()> {
    let classes = svm.classes();
    let (features, labels) = classifier.see_folders(folder, classes)?;
    let mut matrix = ConfusionMatrix::new(classes.len());
    for (features, &label) in features.axis_iter(Axis(0)).zip(&labels) {
        matrix.add(label, svm.classify(features)?)?;
    }
    println!("rows: the class, columns: what it was taken for, in percent of the row");
    for (truth, name) in classes.iter().enumerate() {
        print!("{name:>20}");
        for given in 0..classes.len() {
            print!(" {:6.2}", matrix.percent(truth, given).unwrap_or(0.0));
        }
        println!();
    }
    println!("accuracy {:.2} %", 100.0 * matrix.accuracy().unwrap_or(0.0));
    Ok(())
}
