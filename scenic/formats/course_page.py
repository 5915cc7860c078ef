"""A page that plays simulations, seen from above, with a slider for the time."""

import html
import json
from collections.abc import Sequence
from typing import Any, Final

__all__ = ["course_page"]

_PAGE: Final = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>@TITLE@</title>
<style>
body{margin:0;font:14px system-ui,sans-serif;color:#222;background:#fafafa;display:flex;flex-direction:column;height:100vh}
header,footer{padding:.5rem 1rem;display:flex;gap:1rem;align-items:center;flex-wrap:wrap}
canvas{flex:1;min-height:0;width:100%;background:#fff;border-block:1px solid #ddd}
input[type=range]{flex:1;min-width:12rem}
ul{margin:0;padding-left:1.2rem}
@media (prefers-color-scheme:dark){body{color:#eee;background:#1c1c1e}canvas{background:#111;border-color:#333}}
</style></head><body>
<header><strong>@TITLE@</strong>
<label>simulation <select id="which"></select></label><span id="reason"></span></header>
<canvas id="view" aria-label="objects seen from above"></canvas>
<footer><button id="play">play</button><input id="time" type="range" min="0" value="0" aria-label="time">
<span id="clock"></span><ul id="verdicts"></ul></footer>
<script>
const data=@DATA@;
const $=id=>document.getElementById(id),canvas=$("view"),pen=canvas.getContext("2d");
let course=data[0],timer=null;
data.forEach((c,i)=>$("which").add(new Option(c.about.k,i)));
function bounds(){let b=[1e9,1e9,-1e9,-1e9];for(const s of course.steps)s.positions.forEach((p,i)=>{
 const r=Math.hypot(course.about.objects[i].size[0],course.about.objects[i].size[1])/2+1;
 b=[Math.min(b[0],p[0]-r),Math.min(b[1],p[1]-r),Math.max(b[2],p[0]+r),Math.max(b[3],p[1]+r)]});return b}
function draw(){
 const w=canvas.width=canvas.clientWidth*devicePixelRatio,h=canvas.height=canvas.clientHeight*devicePixelRatio;
 const s=course.steps[+$("time").value],b=course.bounds,k=Math.min(w/(b[2]-b[0]),h/(b[3]-b[1]));
 pen.setTransform(k,0,0,-k,w/2-k*(b[0]+b[2])/2,h/2+k*(b[1]+b[3])/2);pen.lineWidth=1.5/k;
 s.positions.forEach((p,i)=>{const o=course.about.objects[i],q=s.orientations[i];
  pen.beginPath();course.steps.slice(0,s.step+1).forEach((t,n)=>{const x=t.positions[i];if(x)n?pen.lineTo(x[0],x[1]):pen.moveTo(x[0],x[1])});
  pen.strokeStyle="rgba(128,128,128,.5)";pen.stroke();
  const yaw=Math.atan2(2*(q[3]*q[2]+q[0]*q[1]),1-2*(q[1]*q[1]+q[2]*q[2]));
  pen.save();pen.translate(p[0],p[1]);pen.rotate(yaw);
  const c=Array.isArray(o.color)?"rgb("+o.color.slice(0,3).map(v=>Math.round(255*v))+")":"hsl("+(i*67+210)%360+" 60% 55%)";
  pen.fillStyle=c;pen.fillRect(-o.size[0]/2,-o.size[1]/2,o.size[0],o.size[1]);
  pen.strokeStyle="#000a";pen.beginPath();pen.moveTo(0,0);pen.lineTo(0,o.size[1]/2);pen.stroke();pen.restore()});
 $("clock").textContent="step "+s.step+", "+s.time.toFixed(2)+" s"}
function choose(){course=data[+$("which").value];course.bounds??=bounds();$("time").max=course.steps.length-1;$("time").value=0;
 $("reason").textContent=course.about.reason;$("verdicts").replaceChildren(...course.about.requirements.map(r=>{
 const li=document.createElement("li");li.textContent=r.label+": "+(r.verdict||"").toLowerCase().replaceAll("_"," ")+
 (typeof r.robustness=="number"?", by "+r.robustness.toPrecision(3):"");return li}));draw()}
$("which").onchange=choose;$("time").oninput=draw;addEventListener("resize",draw);
$("play").onclick=()=>{if(timer){clearInterval(timer);timer=null;$("play").textContent="play";return}
 $("play").textContent="pause";if(+$("time").value>=+$("time").max)$("time").value=0;
 timer=setInterval(()=>{if(+$("time").value>=+$("time").max){$("play").click();return}$("time").value++;draw()},
 Math.max(20,1000*course.about.timestep))};
choose();
</script></body></html>
"""


def course_page(title: str, courses: Sequence[tuple[dict[str, Any], Sequence[dict[str, Any]]]]) -> str:
    """The page: of each simulation what `course_document` and `step_documents` give."""
    data = [
        {
            "about": {key: about[key] for key in ("k", "timestep", "reason", "objects", "requirements")},
            "steps": [{key: value for key, value in step.items() if key != "actions"} for step in steps],
        }
        for about, steps in courses
    ]
    # Nothing in the data may end the script.
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    return _PAGE.replace("@TITLE@", html.escape(title)).replace("@DATA@", text)
