#pragma once

/// @file
/// The zoom camera table that SAND2004-6198 prints in Appendix D.

namespace longarm::tests {

inline constexpr const char* kReportZoomFile = R"(<?xml version="1.0"?><SR_world><SR_filename> zoom_cam.xml </SR_filename>
<SR_comment>Sony Zoom Camera</SR_comment>
<SR_cam> zcam <SR_zoom> 0.0 <SR_cam_int>{740.09 741.60 -4.58 344.25 212.84 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.004 0.041 0.006 0.009 -0.004 0.034 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 0.025 <SR_cam_int> {794.40 800.52 -6.28 327.35 251.45 0.0 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.004 0.040 0.009 0.056 0.016 0.032 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 0.05 <SR_cam_int> {844.86 849.04 -7.24 316.87 219.260 0. 0. 0. 0. } </SR_cam_int> <SR_cam_ext> {-0.002 0.041 -0.000 0.022 0.022 0.032 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 0.1 <SR_cam_int> {1004.12 1005.49 -5.17 329.62 227.659 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.002 0.041 0.008 0.034 0.004 0.033 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 0.15 <SR_cam_int> {1208.51 1207.932 -5.85 358.46 249.57 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.002 0.041 0.014 0.052 -0.020 0.033 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 0.3 <SR_cam_int> {2314.0 2319.32 -15.74 321.77 139.95 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.002 0.042 0.019 0.001 0.003 0.034 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 0.4 <SR_cam_int> {3500.0 3500.0 0.0 320.0 240.0 0.0 0.0 0.0 0.0} </SR_cam_int> <SR_cam_ext> {-0.001 0.041 0.021 0.078 0.051 0.032 } </SR_cam_ext> </SR_zoom>
<SR_zoom> 1.0 <SR_cam_int> {29600.0 29600.0 0.0 320.0 240.0 0.0 0.0 0.0 0.0} </SR_cam_int> <SR_cam_ext> {-0.001 0.041 0.021 0.022 0.022 0.032 } </SR_cam_ext> </SR_zoom></SR_cam></SR_world>
)";

}  // namespace longarm::tests
