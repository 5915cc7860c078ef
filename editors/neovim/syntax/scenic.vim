" Vim syntax file of Scenic. Generated from grammar/scenic.gram by editors/generate.py (make generate); do not edit.
if exists("b:current_syntax")
  finish
endif
runtime! syntax/python.vim
unlet! b:current_syntax

syn keyword scenicStatement as assert async break continue del do elif else except finally for from global if import nonlocal pass raise require return try while with yield
syn keyword scenicOperator and at await by in is lambda new not of on or to until
syn keyword scenicConstant False None True
syn keyword scenicVariable ego globalParameters self workspace
syn keyword scenicClass Behavior BoxRegion BoxShape CircularRegion ConeShape CylinderShape Discrete DiscreteRange Distribution DynamicScenario File Files GridRegion GuardViolation InvariantViolation MeshShape MeshSurfaceRegion MeshVolumeRegion Modifier Monitor Mutator Normal Object Options Orientation OrientedPoint PathRegion Point PointSetRegion PolygonalFootprintRegion PolygonalRegion PolygonalVectorField PolylineRegion PreconditionViolation Range RectangularRegion Region RejectionException SectorRegion Shape SpheroidRegion SpheroidShape TimeSeries TruncatedNormal Uniform Vector VectorField VerifaiDiscreteRange VerifaiOptions VerifaiParameter VerifaiRange Workspace everywhere nowhere
syn match scenicFunction /\<\%(FacingDirectlyAwayFrom\|FacingDirectlyToward\|distributionFunction\|distributionMethod\|AtomicProposition\|ApparentlyFacing\|BottomFrontRight\|NotVisibleFromOp\|RelativePosition\|ApparentHeading\|BottomBackRight\|BottomFrontLeft\|OffsetAlongSpec\|RelativeHeading\|BottomBackLeft\|FacingAwayFrom\|NotVisibleFrom\|NotVisibleSpec\|PropositionAnd\|PropositionNot\|PropositionOr\|TopFrontRight\|VisibleFromOp\|AltitudeFrom\|DistanceFrom\|DistancePast\|FacingToward\|TopBackRight\|TopFrontLeft\|verbosePrint\|ContainedIn\|OffsetAlong\|TopBackLeft\|VisibleFrom\|VisibleSpec\|AltitudeTo\|Eventually\|FrontRight\|Intersects\|NotVisible\|RelativeTo\|simulation\|AngleFrom\|BackRight\|Following\|FrontLeft\|RestingOn\|RightSpec\|localPath\|BackLeft\|LeftSpec\|OffsetBy\|resample\|AngleTo\|FieldAt\|Implies\|Visible\|Always\|Behind\|Beyond\|Bottom\|CanSee\|Facing\|Follow\|filter\|Above\|Ahead\|Below\|Front\|Right\|Until\|float\|hypot\|range\|round\|Back\|Left\|Next\|With\|Top\|abs\|cos\|int\|len\|max\|min\|sin\|str\|tan\|At\|In\|On\)\ze(/
syn match scenicProperty /\<with\s\+\zs\h\w*\ze\s/
syn match scenicProperty /^\s\+\zs\h\w*\ze\s*\%(\[[a-z, ]\+\]\)\?\s*:\s*[^[:space:]#:=]/
syn match scenicOperator /\<\%(eventually\|intersects\|following\|implies\|visible\|always\|behind\|beyond\|facing\|follow\|above\|below\|next\)\>\ze\s\+\%(\%(intersects\|relative\|implies\|visible\|behind\|offset\|ahead\|right\|until\|left\|and\|can\|deg\|not\|at\|if\|in\|is\|or\)\>\)\@![[:alnum:]_\"'([{]/
syn match scenicOperator /\%([[:alnum:]_)\]]\s\)\@2<=\%(seconds\|steps\|deg\)\>\%(\s*[=(.]\)\@!/
syn match scenicOperator /\<\%(bottom\s\+back\s\+left\s\+of\|bottom\s\+back\s\+right\s\+of\|bottom\s\+front\s\+left\s\+of\|bottom\s\+front\s\+right\s\+of\|facing\s\+directly\s\+away\s\+from\|top\s\+back\s\+left\s\+of\|top\s\+back\s\+right\s\+of\|top\s\+front\s\+left\s\+of\|top\s\+front\s\+right\s\+of\|apparent\s\+heading\s\+of\|apparent\s\+heading\s\+to\|back\s\+left\s\+of\|back\s\+right\s\+of\|facing\s\+away\s\+from\|facing\s\+directly\s\+toward\|front\s\+left\s\+of\|front\s\+right\s\+of\|minimum\s\+distance\s\+from\|minimum\s\+distance\s\+to\|not\s\+visible\s\+from\|relative\s\+heading\s\+of\|relative\s\+position\s\+of\|ahead\s\+of\|altitude\s\+from\|altitude\s\+to\|angle\s\+from\|angle\s\+to\|apparently\s\+facing\|back\s\+of\|bottom\s\+of\|can\s\+see\|contained\s\+in\|distance\s\+from\|distance\s\+past\|distance\s\+to\|facing\s\+toward\|front\s\+of\|initial\s\+scenario\|left\s\+of\|not\s\+visible\|offset\s\+along\|offset\s\+by\|relative\s\+to\|resting\s\+on\|right\s\+of\|top\s\+of\|visible\s\+from\)\>/
syn match scenicStatement /^\s*\zs\%(simulator\|override\|mutate\|record\|model\|param\|take\|type\)\>\ze\s\+\%(\%(intersects\|relative\|implies\|visible\|behind\|offset\|ahead\|right\|until\|left\|and\|can\|deg\|not\|at\|if\|in\|is\|or\)\>\)\@![[:alnum:]_\"'([{]/
syn match scenicStatement /^\s*\zs\%(terminate\s\+simulation\s\+when\|async\s\+def\|async\s\+for\|async\s\+with\|do\s\+choose\|do\s\+shuffle\|interrupt\s\+when\|require\s\+monitor\|terminate\s\+after\|terminate\s\+simulation\|terminate\s\+when\|wait\s\+for\|wait\s\+until\)\>\%(\s*[=(.]\)\@!/
syn match scenicStatement /^\s*\zs\%(terminate\|mutate\|abort\|wait\)\ze\s*\%($\|[#;]\)/
syn match scenicStatement /^\s*\zs\%(match\|case\)\>\ze\s.*:\s*\%(#.*\)\?$/
syn match scenicStatement /^\s*\zs\%(precondition\|invariant\|compose\|setup\)\ze\s*:/
syn match scenicDefinition /\<\%(behavior\|scenario\|monitor\|class\|def\)\>\ze\s\+\h\w*/ nextgroup=scenicDefined skipwhite
syn match scenicDefined /\h\w*/ contained

hi def link scenicStatement Statement
hi def link scenicDefinition Structure
hi def link scenicDefined Type
hi def link scenicOperator Operator
hi def link scenicConstant Constant
hi def link scenicVariable Identifier
hi def link scenicClass Type
hi def link scenicFunction Function
hi def link scenicProperty Identifier

let b:current_syntax = "scenic"
