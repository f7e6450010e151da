# Draws velocity.svg from the plots of a quickstart report:
#   cd quickstart-report/plots && gnuplot ../../docs/figures/velocity.gp
set terminal svg size 720,380 dynamic enhanced font 'sans-serif,14' background rgb 'white'
set output '../../docs/figures/velocity.svg'
set encoding utf8
set datafile separator comma
set datafile columnheaders
set border 3
set tics nomirror out scale 0.5
set xlabel '{/:Italic v_x} / √({/:Italic gd})'
set ylabel '{/:Italic z} / {/:Italic d}'
set yrange [0:13]
set xrange [0:*]
set key outside right top Left reverse samplen 2 spacing 1.15
set errorbars 0.6
z = 'z [d]'
v = 'velocity [sqrt(g d)]'
e = 'velocity [sqrt(g d)] error'
array file[5] = ['1_theta23', '2_theta24_2', '3_theta24_8', '4_theta25_5', '5_theta26_5']
array name[5] = ['23°, fitted', '24.2°, fitted', '24.8°, predicted', '25.5°, fitted', '26.5°, predicted']
array colour[5] = ['#7b8794', '#7b8794', '#d1495b', '#7b8794', '#2b7fc4']
array shape[5] = [4, 6, 7, 8, 5]
plot for [k=1:5] file[k].'_band.csv' using v:z with filledcurves closed \
       fc rgb colour[k] fs transparent solid 0.3 noborder notitle, \
     for [k=1:5] file[k].'_continuum.csv' using v:z with lines lw 1.6 lc rgb colour[k] notitle, \
     for [k=1:5] file[k].'_dem.csv' using v:z:e with xerrorbars \
       pt shape[k] ps 0.6 lc rgb colour[k] title name[k], \
     NaN with lines lw 1.6 lc rgb 'black' title 'continuum, ± 1 s.e.', \
     NaN with points pt 6 ps 0.6 lc rgb 'black' title 'DEM, ± 1 s.e.'
