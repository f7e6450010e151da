# Start state (CSV) -> LAMMPS data file, atom style sphere.
#   zcat FILE.csv.gz | awk -f data_file.awk > FILE.data
# Type 1 flows, type 2 is frozen. Mass unit: a grain of diameter 1, so the density is 6/pi.
# The comment "# box: X Y Z" gives the periods; Z = 0: not periodic. A periodic box can be sheared.
BEGIN { FS = ","; density = 6.0 / (4.0 * atan2(1.0, 1.0)) }
/^# box:/ { split($0, box, " ") }
/^#/ { next }
!header { header = 1; next }
{
  grains++
  at[grains] = sprintf("%d %s %.15g %s %s %s", $11 + 1, $10, density, $1, $2, $3)
  motion[grains] = $4 " " $5 " " $6 " " $7 " " $8 " " $9
  if ($3 + 0.0 > top) top = $3 + 0.0
  if ($3 + 0.0 < bottom) bottom = $3 + 0.0
}
END {
  print "start state of a granular flow\n\n" grains " atoms\n2 atom types\n"
  print 0, box[3], "xlo xhi\n" 0, box[4], "ylo yhi"
  if (box[5] > 0) print 0, box[5], "zlo zhi\n0 0 0 xy xz yz"
  else print bottom - 1.0, top + 1.0, "zlo zhi"
  print "\nAtoms # sphere\n"
  for (i = 1; i <= grains; i++) print i, at[i]
  print "\nVelocities\n"
  for (i = 1; i <= grains; i++) print i, motion[i]
}
