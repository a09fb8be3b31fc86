#![allow(warnings, clippy::all, clippy::pedantic, clippy::nursery, clippy::restriction)]
#[path = "../tests/it/support/stacks.rs"] mod stacks;
use nalgebra::*; use whole_body::*;
const DIRECTIONS: [[f64; 3]; 16] = [[1.0,0.0,0.0],[0.0,0.0,1.0],[-1.0,0.0,0.0],[0.0,1.0,0.0],[0.0,-1.0,0.0],[0.0,0.0,-1.0],[1.0,1.0,1.0],[-1.0,0.3,0.8],[0.2,-1.0,0.5],[-0.7,-0.7,0.1],[0.001,0.0,1.0],[-1.0,0.001,0.3],[1.0,0.0,1.0],[0.0,1.0,1.0],[0.6,0.0,-0.6],[0.5,-1.0,0.0]];
fn pose(m:&Model,q:&[f64],f:FrameId)->Isometry3<f64>{ Data::new(m).pose(m,q).unwrap().world_from(f).unwrap() }
fn sv(m:&Model,q:&[f64],f:FrameId)->Vec<f64>{ let mut j=Matrix6xX::zeros(m.velocity_count()); Data::new(m).pose(m,q).unwrap().jacobian_into(f,Axes::World,&mut j).unwrap(); let mut s:Vec<f64>=j.svd(false,false).singular_values.iter().copied().collect(); s.sort_by(|a,b|b.total_cmp(a)); s }
fn main(){
  let args:Vec<String>=std::env::args().skip(1).collect();
  let pm=stacks::panda();
  let urdf=include_str!("urdf/two_arms.urdf");
  let lm=Model::from_urdf(urdf,&Description{tips:vec!["left_hand".to_owned()],..Description::default()}).unwrap();
  let mut ls=lm.neutral(); for (j,a) in [("left_elbow",-1.5),("left_shoulder_pitch",0.5)] { let id=lm.joint_id(j).unwrap(); ls[lm.joint(id).unwrap().position_index]=a; }
  let arms=[(pm,"panda_hand_tcp",Vector3::new(0.0,0.0,0.333),vec![0.0,-0.785,0.0,-2.356,0.0,1.571,0.785]),(lm,"left_hand",Vector3::new(0.0,0.2,1.2),ls)];
  let mut cnt=[[0;2];2]; let mut id=0;
  for pose_task in [false,true] { for (ai,(m,h,sh,st)) in arms.iter().enumerate() { for d in DIRECTIONS { for dist in [1.2,2.0] {
    let name=format!("{id}"); id+=1; if !args.is_empty() && !args.contains(&name){continue;}
    let trace=!args.is_empty();
    let hand=m.frame_id(h).unwrap();
    let target=sh+dist*Unit::new_normalize(Vector3::from(d)).into_inner();
    let mut b=Ik::builder(m);
    let mut ik; let mut q=st.clone();
    let (mut tp,mut tf)=(None,None);
    if pose_task { tf=Some(b.push("pose",FrameTask::new(hand))); b.push("posture",PostureTask::new()); }
    else { tp=Some(b.push("position",PositionTask::new(hand))); b.push("orientation",OrientationTask::new(hand)); b.push("posture",PostureTask::new()); }
    ik=b.build_at(&q).unwrap();
    if let Some(t)=tf { let mut p=pose(m,&q,hand); p.translation.vector=target; ik.task_mut(t).unwrap().set_target(p).unwrap(); }
    if let Some(t)=tp { ik.task_mut(t).unwrap().set_target(Point3::from(target)).unwrap(); }
    let mut worst=[0.0f64;2]; let mut dmin=f64::INFINITY;
    for t in 0..12000 { let s=ik.step(&q,1e-3).unwrap(); let most=|v:&[f64]|v.iter().fold(0.0f64,|a,b|a.max(b.abs()));
      if t>=11000 { worst[0]=worst[0].max(most(s.velocity())); worst[1]=worst[1].max(most(s.acceleration())); }
      let lv:Vec<String>=s.levels().map(|l|format!("{:.4}",l.slack)).collect(); let it=s.iterations(); let lim:Vec<String>=s.active_limits().map(|l|format!("{}:{:?}",l.entry,l.kind)).collect();
      s.integrate(&mut q).unwrap(); if trace && t>11970 { let p=pose(m,&q,hand); let e=(p.rotation.inverse()*pose(m,st,hand).rotation).scaled_axis(); println!("{t} it {it} slack {} v {} a {} e {:?}",lv.join(" "),ik.velocity().iter().map(|x|format!("{x:.5}")).collect::<Vec<_>>().join(" "),ik.acceleration().iter().map(|x|format!("{x:.2}")).collect::<Vec<_>>().join(" "),e.as_slice()); }
      if trace && (t%1000==0 || (t>11900 && t%10==0)) { println!("t {t} d {:.5} s {} v {} q {} lim {}",(pose(m,&q,hand).translation.vector-target).norm(),sv(m,&q,hand).iter().map(|x|format!("{x:.4}")).collect::<Vec<_>>().join(" "),ik.velocity().iter().map(|x|format!("{x:.3}")).collect::<Vec<_>>().join(" "),q.iter().map(|x|format!("{x:.3}")).collect::<Vec<_>>().join(" "),lim.join(" ")); }
    }
    let rests=worst[0]<1e-2&&worst[1]<0.1; cnt[pose_task as usize][ai]+=rests as usize;
    if !rests { println!("{name} {} {} {d:?} {dist} v {:.3} a {:.2} d {:.4}",if pose_task{"pose"}else{"pos/ori"},m.name(),worst[0],worst[1],(pose(m,&q,hand).translation.vector-target).norm()); }
  }}}}
  println!("rest: pos/ori panda {} lift {}; pose panda {} lift {} of 32 each",cnt[0][0],cnt[0][1],cnt[1][0],cnt[1][1]);
}
