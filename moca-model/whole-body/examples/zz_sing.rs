#![allow(warnings, clippy::all, clippy::pedantic, clippy::nursery, clippy::restriction)]
#[path = "../tests/it/support/arms.rs"] mod arms_;
#[path = "../tests/it/support/stacks.rs"] mod stacks;
mod sup { pub(crate) use super::stacks; }
use nalgebra::*;
use whole_body::*;
const STARTS: &str = include_str!("../tests/it/singular_starts.txt");
fn apart(t:&Isometry3<f64>, n:&Isometry3<f64>)->f64{(t.translation.vector-n.translation.vector).norm()}
fn pose(m:&Model,q:&[f64],f:FrameId)->Isometry3<f64>{ Data::new(m).pose(m,q).unwrap().world_from(f).unwrap() }
fn sv(m:&Model,q:&[f64],f:FrameId)->Vec<f64>{ let mut j=Matrix6xX::zeros(m.velocity_count()); Data::new(m).pose(m,q).unwrap().jacobian_into(f,Axes::World,&mut j).unwrap(); let mut s:Vec<f64>=j.svd(false,false).singular_values.iter().copied().collect(); s.sort_by(|a,b|b.total_cmp(a)); s }
fn main(){
  let arms=arms_::arms();
  let args:Vec<String>=std::env::args().skip(1).collect();
  let only:Vec<usize>=args.iter().filter_map(|a|a.parse().ok()).collect();
  let trace=!only.is_empty();
  if args.iter().any(|a|a=="ur5") {
    let m=arms_::arm("ur5"); let mut q=vec![0.0,-0.6,1.6,0.2,0.0,0.0]; let tool=m.frames().last().unwrap().0;
    let mut target=pose(&m,&q,tool); target.translation.vector.x-=0.1;
    let mut b=Ik::builder(&m); let task=b.push("pose",FrameTask::new(tool)); b.push("posture",PostureTask::new());
    let mut ik=b.build_at(&q).unwrap(); ik.task_mut(task).unwrap().set_target(target).unwrap();
    for t in 0..3000u32{ ik.step(&q,1e-3).unwrap().integrate(&mut q).unwrap(); if t%100==0 { let s=sv(&m,&q,tool); let p=pose(&m,&q,tool); println!("t {t} d {:.6} ang {:.6} s {:.5} v {} q {}",apart(&target,&p),p.rotation.angle_to(&target.rotation),s[5],ik.velocity().iter().map(|x|format!("{x:.4}")).collect::<Vec<_>>().join(" "),q.iter().map(|x|format!("{x:.4}")).collect::<Vec<_>>().join(" ")); } }
    return; }
  let (mut miss,mut late,mut mov,mut mov6)=(0,0,0,0);
  for (i,line) in STARTS.lines().enumerate(){
    if trace && !only.contains(&i){continue;}
    let (a,n)=line.split_once(' ').unwrap(); let ai=a.parse::<usize>().unwrap(); let m=&arms[ai];
    let n:Vec<f64>=n.split(' ').map(|t|t.parse().unwrap()).collect();
    let target=Isometry3::from_parts(Translation3::new(n[0],n[1],n[2]),UnitQuaternion::new_unchecked(Quaternion::new(n[6],n[3],n[4],n[5])));
    let und=n[7]; let mut q=n[8..].to_vec(); let tool=m.frames().last().unwrap().0;
    let mut b=Ik::builder(m); let task=b.push("pose",FrameTask::new(tool)); b.push("posture",PostureTask::new());
    let mut ik=b.build_at(&q).unwrap(); ik.task_mut(task).unwrap().set_target(target).unwrap();
    let s0=sv(m,&q,tool); let d0=apart(&target,&pose(m,&q,tool));
    let mut arr=None; let mut v1=f64::NAN; let mut slack=0.0;
    for t in 0..10000u32{
      if arr.is_none() && apart(&target,&pose(m,&q,tool))<1e-3 {arr=Some(t);}
      if arr.is_some_and(|s|t>s+1000){break;}
      let st=ik.step(&q,1e-3).unwrap(); slack=st.slack(task).unwrap(); st.integrate(&mut q).unwrap();
      if trace && (t%250==0 || (t<300 && t%25==0)) { let s=sv(m,&q,tool); let p=pose(m,&q,tool); let act:Vec<String>=vec![];
        println!("t {t} d {:.5} ang {:.4} s {:?} v {:?} q {:?} lim {}",apart(&target,&p),p.rotation.angle_to(&target.rotation),s.iter().skip(s.len().min(6)-2).map(|x|format!("{x:.4}")).collect::<Vec<_>>(),ik.velocity().iter().map(|x|format!("{x:.2}")).collect::<Vec<_>>().join(" "),q.iter().map(|x|format!("{x:.3}")).collect::<Vec<_>>().join(" "), act.join(","));}
    }
    v1=ik.velocity().iter().fold(0.0_f64,|a,v|a.max(v.abs()));
    let p=pose(m,&q,tool); let d=apart(&target,&p); let ang=p.rotation.angle_to(&target.rotation);
    let ok=arr.is_some() && d<1e-3;
    let time=arr.map(|t|t as f64*1e-3);
    let is_late=ok && time.unwrap()>1.5*und.max(0.1);
    let s=sv(m,&q,tool);
    if !ok {miss+=1;} if is_late{late+=1;} if ok && v1>0.01 {mov+=1; if m.velocity_count()==6{mov6+=1;}}
    if !ok || is_late || v1>0.01 { println!("{i} {} d0 {d0:.3} s0 {:.4} {:.4} und {und:.3} time {:?} end d {d:.5} ang {ang:.5} slack {slack:.4} v1 {v1:.4} s1 {:.4} {}{}{}",m.name(),s0[4],s0[5],time,s[5],if !ok{"MISS "}else{""},if is_late{"LATE "}else{""},if v1>0.01{"MOVES"}else{""}); }
  }
  println!("miss {miss} late {late} moving {mov} of them 6-axis {mov6}");
}
